//! Long work beside the server.

use std::sync::Arc;

/// Long work beside the server, one piece at a time.
#[derive(Clone, Default)]
pub struct Turn(Arc<tokio::sync::Mutex<()>>);

impl Turn {
    /// Works once what came before is done.
    ///
    /// # Errors
    /// A worker thread that ended early.
    pub async fn work<T: Send + 'static>(&self, work: impl FnOnce() -> T + Send + 'static) -> std::io::Result<T> {
        let turn = Arc::clone(&self.0).lock_owned().await;
        let work = move || {
            // Held to the end, also where nobody waits any longer.
            let _turn = turn;
            work()
        };
        tokio::task::spawn_blocking(work).await.map_err(std::io::Error::other)
    }
}
