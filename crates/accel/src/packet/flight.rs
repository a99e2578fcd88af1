//! Single rays, several on their way at once: while one waits for memory the others go on.
#![expect(unsafe_code, reason = "unchecked reads; each place states why it is sound")]

use crate::leaves::UserLeaves;
use crate::ray_constants::{RayConstants, is_traceable};
use crate::search::Query;
use crate::simd::Simd;
use crate::stack::Waiting;
use crate::tree::Tree;
use std::array::from_fn;
use std::mem::MaybeUninit;
use std::time::{Duration, Instant};
use steradian_math::Ray;

/// Number of rays in flight at once. Measured.
const FLIGHT: usize = 6;

/// So many rays are traced either way to see which is faster, when there are [`ENOUGH`] of them.
const TRIAL: usize = 24;
const ENOUGH: usize = 5 * TRIAL;

/// Largest time of the trial in flight, relative to the trial of single rays, at which it counts as faster: its rays
/// find in the caches the lines that the first have brought.
const WORTH: f32 = 0.85;

/// Traces the rays with given places alone, and hands over their answers. In a large tree they may wait for
/// memory or not: the clock tells. `ask` answers for one ray. All ways give the same bits.
#[inline(always)]
pub(super) fn alone<S: Simd, U: UserLeaves, Q: Query<S, U>>(
    ask: impl Fn(&Ray) -> Q::Answer,
    s: S,
    tree: &Tree,
    rays: &[Ray],
    users: &U,
    mut places: &[u32],
    mut answer: impl FnMut(usize, Q::Answer),
) {
    let mut times = [Duration::ZERO; 2];
    // Time a few rays each way, in turn and interleaved, and trace the rest by the faster way.
    let trials = if tree.is_large() && places.len() >= ENOUGH { 2 } else { 0 };
    for part in 0..=trials {
        let is_trial = part < trials;
        let some = places.split_off(..if is_trial { TRIAL } else { places.len() }).unwrap_or_default();
        let flies = if is_trial { part == 1 } else { times[1] < times[0].mul_f32(WORTH) };
        let start = is_trial.then(Instant::now);
        if flies {
            trace_packet::<S, U, Q>(s, tree, rays, users, some, &mut answer);
        } else {
            in_turn(&ask, rays, some, &mut answer);
        }
        if let Some(start) = start {
            times[part] = start.elapsed();
        }
    }
}

/// Traces rays one after the other, as single-ray queries do. A function of its own: values that packets keep in
/// registers would be fetched anew for each ray.
#[inline(never)]
fn in_turn<A>(ask: &impl Fn(&Ray) -> A, rays: &[Ray], places: &[u32], answer: &mut impl FnMut(usize, A)) {
    for place in places.iter().map(|&place| place as usize) {
        answer(place, ask(&rays[place]));
    }
}

/// Traces rays interleaved, several in flight at once.
#[inline(always)]
fn trace_packet<S: Simd, U: UserLeaves, Q: Query<S, U>>(
    s: S,
    tree: &Tree,
    rays: &[Ray],
    users: &U,
    places: &[u32],
    answer: &mut impl FnMut(usize, Q::Answer),
) {
    let mut places = places.iter().map(|&place| place as usize);
    let mut queries = [const { MaybeUninit::<Q>::uninit() }; FLIGHT];
    let mut stacks = [const { MaybeUninit::<Q::Stack>::uninit() }; FLIGHT];
    let mut place_of = [0; FLIGHT];
    // The slots: first come those that have a ray, which are all that are open once each has been looked at.
    let mut order: [usize; FLIGHT] = from_fn(|i| i);
    let (mut open, mut flying) = (FLIGHT, 0);
    while open > 0 {
        let mut i = 0;
        while i < open {
            let slot = order[i];
            if i < flying {
                // SAFETY: what has a ray has been written.
                let (query, stack) = unsafe { (queries[slot].assume_init_mut(), stacks[slot].assume_init_mut()) };
                let place = place_of[slot];
                // Advance one query by a node or block, then fetch the next one while the other rays use the processor.
                let Some(found) = query.step(stack, s, tree, &rays[place], users) else {
                    tree.arena.prefetch(query.current());
                    i += 1;
                    continue;
                };
                answer(place, found);
            }
            // The slot is free for the next ray.
            let next = places.find(|&place| {
                let may_hit = is_traceable(&rays[place]);
                if !may_hit {
                    answer(place, Q::Answer::default());
                }
                may_hit
            });
            match next {
                Some(place) => {
                    let ray = &rays[place];
                    queries[slot].write(Q::at_root(s, tree, ray, &RayConstants::new(ray, &tree.bounds)));
                    Q::Stack::emptied(&mut stacks[slot]);
                    place_of[slot] = place;
                    flying = flying.max(i + 1);
                    i += 1;
                }
                None => {
                    // No ray is left: retire the slot by exchanging it with the last open one.
                    open -= 1;
                    flying = flying.min(open);
                    order.swap(i, open);
                }
            }
        }
    }
}
