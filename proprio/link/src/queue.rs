//! A bounded queue that never blocks the sender.

use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Items from one thread to another. When it is full, the oldest item is dropped and counted.
#[derive(Debug)]
pub struct Queue<T> {
    capacity: usize,
    state: Mutex<State<T>>,
    filled: Condvar,
}

#[derive(Debug)]
struct State<T> {
    items: VecDeque<T>,
    dropped: u64,
}

impl<T> Queue<T> {
    /// An empty queue for `capacity` items.
    pub fn new(capacity: usize) -> Self {
        let state = State { items: VecDeque::new(), dropped: 0 };
        Self { capacity, state: Mutex::new(state), filled: Condvar::new() }
    }

    fn state(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Puts an item at its end.
    pub fn push(&self, item: T) {
        let mut state = self.state();
        if state.items.len() == self.capacity {
            state.items.pop_front();
            state.dropped += 1;
        }
        state.items.push_back(item);
        drop(state);
        self.filled.notify_one();
    }

    /// Takes the oldest item; waits up to `wait` for one.
    pub fn pop(&self, wait: Duration) -> Option<T> {
        let state = self.state();
        let waited = self.filled.wait_timeout_while(state, wait, |state| state.items.is_empty());
        waited.unwrap_or_else(PoisonError::into_inner).0.items.pop_front()
    }

    /// Counts items that were dropped before they came here.
    pub fn add_dropped(&self, items: u64) {
        self.state().dropped += items;
    }

    /// Number of items that were dropped.
    pub fn dropped(&self) -> u64 {
        self.state().dropped
    }
}

#[cfg(test)]
mod tests {
    use super::{Duration, Queue};

    #[test]
    fn a_full_queue_drops_its_oldest_items_and_counts_them() {
        let queue = Queue::new(3);
        (1..=5).for_each(|item| queue.push(item));
        let left: Vec<i32> = std::iter::from_fn(|| queue.pop(Duration::ZERO)).collect();
        assert_eq!((left, queue.dropped()), (vec![3, 4, 5], 2));
    }

    #[test]
    fn a_waiting_receiver_gets_an_item_that_comes_meanwhile() {
        let queue = Queue::new(3);
        std::thread::scope(|scope| {
            let waiting = scope.spawn(|| queue.pop(Duration::from_mins(1)));
            queue.push(7);
            assert_eq!(waiting.join().expect("it gets its item"), Some(7));
        });
    }
}
