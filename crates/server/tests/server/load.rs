//! Many pages at once, and pages that go away.

use crate::client::{Server, camera};
use std::sync::Barrier;

/// Twenty pages see the same pictures; those that close in the middle, or never read, hold up nobody.
#[test]
fn many_pages_see_the_same() {
    let server = Server::of("builtin:cornell-box");
    let start = Barrier::new(21);
    std::thread::scope(|scope| {
        let pages: Vec<_> = (0..20)
            .map(|number| {
                let (server, start) = (&server, &start);
                scope.spawn(move || {
                    let mut page = server.page();
                    page.until("a picture", |v| v["type"] == "frame");
                    start.wait();
                    match number % 10 {
                        // Closes at once.
                        0 => None,
                        // Stays, and reads nothing until the others have all.
                        1 => Some((page, Vec::new())),
                        _ => {
                            let is_last = |v: &serde_json::Value| {
                                v["done"] == true && v["kind"] == "render" && v["generation"] == 2
                            };
                            let (_, tiles) = page.until("the end", is_last);
                            Some((page, tiles))
                        }
                    }
                })
            })
            .collect();
        start.wait();
        let mut mover = server.page();
        mover.finished(camera(0.5));
        let seen: Vec<_> = pages.into_iter().filter_map(|page| page.join().unwrap()).collect();
        let whole: Vec<_> = seen.iter().filter(|(_, tiles)| !tiles.is_empty()).collect();
        assert_eq!(whole.len(), 16);
        for (_, tiles) in &whole {
            assert_eq!(*tiles, whole[0].1);
        }
    });
    // Those are gone, sooner or later, and there is room again; for 64 and no more.
    loop {
        let pages: Vec<_> = (0..65).map_while(|_| server.try_page()).collect();
        assert!(pages.len() <= 64);
        if pages.len() == 64 {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(50));
    }
    assert!(server.logged("there are 64 already"));
}
