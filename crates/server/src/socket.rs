//! A page's connection: requests in, states and frames out. A page that reads slowly misses frames, and holds up none.

use crate::{
    app::{App, Refused},
    frame::Frame,
    protocol::{Request, ServerMessage},
    viewer::Task,
};
use axum::{
    extract::{
        State, WebSocketUpgrade,
        ws::{Message, WebSocket},
    },
    http::StatusCode,
    response::{IntoResponse, Response},
};
use std::{
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};
use tokio::sync::{oneshot, watch};

/// Pages at once.
const MOST_SOCKETS: usize = 64;
/// Bytes of a request.
const MOST_BYTES: usize = 64 << 10;
/// Longest time for a page to read a message.
const PATIENCE: Duration = Duration::from_secs(60);

/// Opens a page's connection.
pub async fn open(State(app): State<App>, upgrade: WebSocketUpgrade) -> Response {
    let place = Place::take(&app.sockets);
    let Some(place) = place else {
        app.log.refused("refused a page: there are 64 already");
        return Refused(StatusCode::SERVICE_UNAVAILABLE, "there are 64 pages already".into()).into_response();
    };
    let log = Arc::clone(&app.log);
    upgrade
        .max_message_size(MOST_BYTES)
        .max_frame_size(MOST_BYTES)
        .on_failed_upgrade(move |e| log.refused(&format!("a page's connection failed: {e}")))
        .on_upgrade(move |socket| async move {
            serve(socket, &app).await;
            drop(place);
        })
}

/// A place among the pages.
struct Place(Arc<AtomicUsize>);

impl Place {
    fn take(count: &Arc<AtomicUsize>) -> Option<Self> {
        let more = |n| (n < MOST_SOCKETS).then_some(n + 1);
        count.fetch_update(Ordering::Relaxed, Ordering::Relaxed, more).ok()?;
        Some(Self(Arc::clone(count)))
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Serves a page until it goes away.
async fn serve(mut socket: WebSocket, app: &App) {
    let (mut states, mut frames) = (app.viewer.states.clone(), app.viewer.frames.clone());
    let mut messages = app.viewer.messages.subscribe();
    states.mark_changed();
    frames.mark_changed();
    let mut picture = 0;
    loop {
        // The state first: it tells what a frame of its generation is of.
        let sent = tokio::select! {
            biased;
            come = socket.recv() => match come {
                Some(Ok(message)) => answer(&mut socket, app, &mut states, message).await,
                Some(Err(e)) => {
                    app.log.refused(&format!("a page's connection ended: {e}"));
                    return;
                }
                None => return,
            },
            Ok(()) = states.changed() => tell_state(&mut socket, &mut states).await,
            Ok(message) = messages.recv() => send(&mut socket, Message::Text(message.into())).await,
            Ok(()) = frames.changed() => show(&mut socket, &mut frames, &mut picture).await,
            else => return,
        };
        if sent.is_none() {
            return;
        }
    }
}

/// Sends a message; `None` where the page is gone.
async fn send(socket: &mut WebSocket, message: Message) -> Option<()> {
    tokio::time::timeout(PATIENCE, socket.send(message)).await.ok()?.ok()
}

/// Sends the newest state, where there is one.
async fn tell_state(socket: &mut WebSocket, states: &mut watch::Receiver<Arc<str>>) -> Option<()> {
    let state = states.borrow_and_update().to_string();
    if state.is_empty() { Some(()) } else { send(socket, Message::Text(state.into())).await }
}

/// Sends the newest frame, whose tiles the page may have already.
async fn show(socket: &mut WebSocket, frames: &mut watch::Receiver<Arc<Frame>>, sent: &mut u64) -> Option<()> {
    let frame = Arc::clone(&frames.borrow_and_update());
    let Some(end) = frame.text() else { return Some(()) };
    if *sent != frame.number {
        for tile in &frame.tiles {
            send(socket, Message::Binary(tile.clone())).await?;
        }
        *sent = frame.number;
    }
    send(socket, Message::Text(end.into())).await
}

/// Carries out what a page asks for. It is told what is wrong or the state with the change, then that this was all.
async fn answer(
    socket: &mut WebSocket,
    app: &App,
    states: &mut watch::Receiver<Arc<str>>,
    message: Message,
) -> Option<()> {
    let text = match message {
        Message::Text(text) => text,
        Message::Binary(_) => return tell(socket, app, "requests are texts".into()).await,
        Message::Ping(_) | Message::Pong(_) => return Some(()),
        Message::Close(_) => return None,
    };
    let refused = match serde_json::from_str::<Request>(&text) {
        Ok(request) => {
            let (reply, answer) = oneshot::channel();
            app.viewer.send(Task::Page(request, reply));
            answer.await.ok()?.err()
        }
        Err(e) => Some(format!("the request cannot be read: {e}")),
    };
    if let Some(why) = refused {
        tell(socket, app, why).await?;
    }
    if states.has_changed().ok()? {
        tell_state(socket, states).await?;
    }
    send(socket, Message::Text(ServerMessage::Answered.text().into())).await
}

async fn tell(socket: &mut WebSocket, app: &App, text: String) -> Option<()> {
    app.log.refused(&format!("refused a request: {}", text.lines().next().unwrap_or_default()));
    send(socket, Message::Text(ServerMessage::error(text).text().into())).await
}
