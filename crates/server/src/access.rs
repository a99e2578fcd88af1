//! Who may ask: those who know the token, under a name of this machine, from this page.
//!
//! The token is part of every path, so pages, files, requests and sockets carry it without cookies, in frames of other
//! sites too. A page of another site that guesses the port does not know it. A name that was rebound to this machine
//! (DNS rebinding) shows in the `Host` header, a page of another site in `Origin`.

use std::net::{IpAddr, SocketAddr};

/// Bytes of the token.
const TOKEN_BYTES: usize = 24;

/// Access check of requests: token, port and names of this server.
#[derive(Clone, Debug)]
pub struct Access {
    token: String,
    port: u16,
    /// The name that it was bound to, where that is no address.
    name: Option<String>,
}

/// Why a request is refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Refusal {
    /// No `Host` of this machine.
    #[error("the address in the request's Host header is not this machine's: use the address that was printed")]
    Host,
    /// An `Origin` that is not this page.
    #[error("the request comes from a page of another site")]
    Origin,
    /// No token, or another one.
    #[error("the token in the address is missing or wrong: use the address that was printed, with all of it")]
    Token,
}

impl Access {
    /// With a new token, for a server at an address.
    ///
    /// # Errors
    /// Where the system has no random numbers.
    pub fn new(address: SocketAddr, name: Option<String>) -> std::io::Result<Self> {
        let mut bytes = [0; TOKEN_BYTES];
        getrandom::fill(&mut bytes).map_err(|e| std::io::Error::other(e.to_string()))?;
        let token = bytes.iter().map(|b| format!("{b:02x}")).collect();
        Ok(Self { token, port: address.port(), name })
    }

    /// The token.
    pub fn token(&self) -> &str {
        &self.token
    }

    /// Part of a path after the token, if the request may be answered.
    ///
    /// # Errors
    /// Why not.
    pub fn admit<'p>(&self, path: &'p str, host: Option<&str>, origin: Option<&str>) -> Result<&'p str, Refusal> {
        let host = host.filter(|host| self.is_own(host)).ok_or(Refusal::Host)?;
        if origin.is_some_and(|origin| origin.strip_prefix("http://") != Some(host)) {
            return Err(Refusal::Origin);
        }
        let rest = path.strip_prefix('/').unwrap_or(path);
        let (token, rest) = rest.split_at_checked(self.token.len()).ok_or(Refusal::Token)?;
        let is_same = token.bytes().zip(self.token.bytes()).fold(0, |apart, (a, b)| apart | (a ^ b)) == 0;
        if !is_same || !(rest.is_empty() || rest.starts_with('/')) {
            return Err(Refusal::Token);
        }
        Ok(rest)
    }

    /// True if a `Host` names this server: by an address, as `localhost`, or as the name that it was bound to.
    fn is_own(&self, host: &str) -> bool {
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.is_empty() && port.bytes().all(|b| b.is_ascii_digit()) => (name, port),
            _ => (host, "80"),
        };
        let bare = name.strip_prefix('[').and_then(|n| n.strip_suffix(']')).unwrap_or(name);
        let is_name = |own: &str| name.eq_ignore_ascii_case(own);
        let is_here =
            bare.parse::<IpAddr>().is_ok() || is_name("localhost") || self.name.as_deref().is_some_and(is_name);
        is_here && port.parse() == Ok(self.port)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn access(name: Option<&str>) -> Access {
        Access::new("127.0.0.1:4321".parse().unwrap(), name.map(String::from)).unwrap()
    }

    #[test]
    fn tokens_differ_and_cannot_be_left_out() {
        let one = access(None);
        assert_ne!(one.token(), access(None).token());
        assert_eq!(one.token().len(), 2 * TOKEN_BYTES);
        let admit = |path: &str| one.admit(path, Some("127.0.0.1:4321"), None).map(String::from);
        assert_eq!(admit(&format!("/{}/api/state", one.token())), Ok("/api/state".into()));
        assert_eq!(admit(&format!("/{}", one.token())), Ok(String::new()));
        let upper = one.token().to_uppercase();
        let short = &one.token()[1..];
        for path in
            ["/", "", "/api/state", "/é", &format!("/{upper}x/"), &format!("/{short}/"), &format!("/{}x/", one.token())]
        {
            assert_eq!(admit(path), Err(Refusal::Token), "{path}");
        }
    }

    #[test]
    fn names_of_others_are_refused() {
        let one = access(Some("workstation"));
        let path = format!("/{}/", one.token());
        let admit = |host: Option<&str>| one.admit(&path, host, None).map(|_| ());
        for host in
            ["127.0.0.1:4321", "localhost:4321", "LOCALHOST:4321", "[::1]:4321", "192.168.1.7:4321", "workstation:4321"]
        {
            assert_eq!(admit(Some(host)), Ok(()), "{host}");
        }
        for host in
            ["127.0.0.1", "127.0.0.1:80", "evil.example:4321", "localhost.evil.example:4321", "", ":4321", "127.0.0.1:"]
        {
            assert_eq!(admit(Some(host)), Err(Refusal::Host), "{host}");
        }
        assert_eq!(admit(None), Err(Refusal::Host));
    }

    #[test]
    fn pages_of_others_can_change_nothing() {
        let one = access(None);
        let path = format!("/{}/api/socket", one.token());
        let admit = |origin: &str| one.admit(&path, Some("localhost:4321"), Some(origin)).map(|_| ());
        assert_eq!(admit("http://localhost:4321"), Ok(()));
        for origin in
            ["http://127.0.0.1:4321", "https://localhost:4321", "http://localhost:1", "null", "http://evil.example", ""]
        {
            assert_eq!(admit(origin), Err(Refusal::Origin), "{origin}");
        }
    }
}
