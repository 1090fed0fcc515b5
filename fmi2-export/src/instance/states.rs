//! The FMU states that the master holds: it gets numbers for them, so that a state that was freed, or never was one, is
//! found and not followed.

use std::any::Any;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A taken state; only an instance of the same model can use it.
pub type TakenState = Arc<dyn Any + Send + Sync>;

/// Number by which the master identifies a state: never 0, and not used again after the state is freed.
pub type Handle = usize;

struct Held {
    handle: Handle,
    /// Number of the instance that made it.
    owner: usize,
    state: TakenState,
}

/// All states of this library, by ascending handles.
static STATES: Mutex<(Handle, Vec<Held>)> = Mutex::new((0, Vec::new()));

fn states() -> MutexGuard<'static, (Handle, Vec<Held>)> {
    STATES.lock().unwrap_or_else(PoisonError::into_inner)
}

fn position(held: &[Held], handle: Handle) -> Option<usize> {
    held.binary_search_by_key(&handle, |held| held.handle).ok()
}

/// Takes a state of the instance `owner` into custody.
pub fn hold(owner: usize, state: TakenState) -> Handle {
    let (last, held) = &mut *states();
    *last += 1;
    held.push(Held { handle: *last, owner, state });
    *last
}

/// The state of a handle.
pub fn get(handle: Handle) -> Option<TakenState> {
    let (_, held) = &*states();
    Some(held[position(held, handle)?].state.clone())
}

/// Gives a handle another state; `false` when it has none.
pub fn replace(handle: Handle, state: TakenState) -> bool {
    let (_, held) = &mut *states();
    let place = position(held, handle);
    place.map(|place| std::mem::replace(&mut held[place].state, state)).is_some()
}

/// Frees a state; `false` when there is none.
pub fn free(handle: Handle) -> bool {
    let (_, held) = &mut *states();
    let freed = position(held, handle).map(|place| held.remove(place)).is_some();
    give_back(held);
    freed
}

/// Frees what an instance has made and the master has not freed.
pub fn free_all_of(owner: usize) {
    let (_, held) = &mut *states();
    held.retain(|held| held.owner != owner);
    give_back(held);
}

/// An unloaded library leaves no memory allocated.
fn give_back(held: &mut Vec<Held>) {
    if held.is_empty() {
        *held = Vec::new();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_lives_until_it_is_freed_or_its_owner_is() {
        let state = |number: i32| -> TakenState { Arc::new(number) };
        let number = |handle| get(handle).map(|state| *state.downcast::<i32>().unwrap());
        let (first, second, other) = (hold(1, state(10)), hold(1, state(20)), hold(2, state(30)));
        assert_eq!([first, second, other].map(number), [Some(10), Some(20), Some(30)]);
        assert!(replace(second, state(21)) && number(second) == Some(21));
        assert!(free(first) && !free(first) && !replace(first, state(0)) && number(first).is_none());
        free_all_of(1);
        assert_eq!([second, other].map(number), [None, Some(30)]);
        assert!(free(other));
        assert!(hold(3, state(40)) > other);
        free_all_of(3);
    }
}
