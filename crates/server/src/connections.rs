//! Connections: how many there may be at once, and for how long one may say nothing.
//!
//! Where there is no room for another one, that goes which has waited longest without a request under way. So those who
//! open connections and say nothing keep nobody else away, and the process keeps file descriptors for its files.

use axum::Router;
use hyper::{body::Incoming, server::conn::http1, service::Service as _};
use hyper_util::{
    rt::{TokioIo, TokioTimer},
    service::TowerToHyperService,
};
use std::{
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};
use tokio::{
    net::{TcpListener, TcpStream},
    task::AbortHandle,
};

/// After a failure to take a connection, where there are too many open files.
const BREATH: Duration = Duration::from_millis(100);

/// Bounds on connections.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Connections at once, besides those that became sockets of pages.
    pub connections: usize,
    /// Longest time for the head of a request, also when the connection had requests before.
    pub silence: Duration,
}

impl Default for Limits {
    fn default() -> Self {
        Self { connections: 96, silence: Duration::from_secs(15) }
    }
}

/// A connection that is open.
struct Open {
    task: AbortHandle,
    /// Requests under way.
    requests: Arc<AtomicUsize>,
}

/// A request under way.
struct Underway(Arc<AtomicUsize>);

impl Drop for Underway {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Answers all that come, for ever.
pub async fn serve(listener: TcpListener, router: Router, limits: Limits) {
    // In the order in which they came.
    let mut open: Vec<Open> = Vec::new();
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            tokio::time::sleep(BREATH).await;
            continue;
        };
        open.retain(|o| !o.task.is_finished());
        if open.len() >= limits.connections {
            let Some(silent) = open.iter().position(|o| o.requests.load(Ordering::Relaxed) == 0) else { continue };
            open.remove(silent).task.abort();
        }
        let requests = Arc::default();
        let task = tokio::spawn(answer(stream, router.clone(), Arc::clone(&requests), limits.silence)).abort_handle();
        open.push(Open { task, requests });
    }
}

/// Answers the requests of a connection.
async fn answer(stream: TcpStream, router: Router, requests: Arc<AtomicUsize>, silence: Duration) {
    let _ = stream.set_nodelay(true);
    let router = TowerToHyperService::new(router);
    let service = hyper::service::service_fn(move |request: hyper::Request<Incoming>| {
        requests.fetch_add(1, Ordering::Relaxed);
        let underway = Underway(Arc::clone(&requests));
        let answer = router.call(request);
        async move {
            let answer = answer.await;
            drop(underway);
            answer
        }
    });
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(silence);
    // What a client does wrong ends its connection.
    let _ = http.serve_connection(TokioIo::new(stream), service).with_upgrades().await;
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::routing::get;
    use std::io::{Read, Write};

    /// A server in a thread of its own, for as long as the process lives; its address.
    fn server(limits: Limits) -> std::net::SocketAddr {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        listener.set_nonblocking(true).unwrap();
        let address = listener.local_addr().unwrap();
        std::thread::spawn(move || {
            let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
            runtime.block_on(async {
                let router = Router::new().route("/", get(|| async { "here" }));
                serve(TcpListener::from_std(listener).unwrap(), router, limits).await;
            });
        });
        address
    }

    /// All that comes until the other side closes.
    fn rest(mut stream: std::net::TcpStream) -> String {
        let mut all = Vec::new();
        // A reset is an end as well.
        let _ = stream.read_to_end(&mut all);
        String::from_utf8(all).unwrap()
    }

    const HALF: &[u8] = b"GET / HTTP/1.1\r\nHost: x\r\n";

    #[test]
    fn those_that_say_nothing_make_room() {
        let address = server(Limits { connections: 4, silence: Duration::from_secs(100_000) });
        let mut silent: Vec<_> = (0..20).map(|_| std::net::TcpStream::connect(address).unwrap()).collect();
        for (k, stream) in silent.iter_mut().enumerate() {
            if k % 2 == 0 {
                let _ = stream.write_all(HALF);
            }
        }
        let mut one = std::net::TcpStream::connect(address).unwrap();
        one.write_all(HALF).unwrap();
        one.write_all(b"Connection: close\r\n\r\n").unwrap();
        assert!(rest(one).ends_with("\r\n\r\nhere"));
        // Those that came first are closed.
        silent.drain(..16).for_each(|stream| assert_eq!(rest(stream), ""));
    }

    #[test]
    fn half_a_request_is_waited_for_only_so_long() {
        let address = server(Limits { connections: 4, silence: Duration::from_millis(20) });
        let mut half = std::net::TcpStream::connect(address).unwrap();
        half.write_all(HALF).unwrap();
        assert!(!rest(half).contains("here"));
        assert_eq!(rest(std::net::TcpStream::connect(address).unwrap()), "");
    }
}
