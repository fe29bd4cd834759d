//! Downsampling of long recordings to bounded memory: bins with their minimum and maximum, and decimation.

/// `C` channels over time, in bins of equal numbers of rows: all rows at first, then between `kept` and twice as many bins.
#[derive(Debug, Clone)]
pub struct Timeline<const C: usize> {
    kept: usize,
    bins: Vec<Bin<C>>,
    rows_per_bin: u64,
    rows_in_last: u64,
}

/// The rows of one stretch of time.
#[derive(Debug, Clone, Copy)]
pub struct Bin<const C: usize> {
    first_us: u64,
    last_us: u64,
    cells: [Cell; C],
}

/// One channel in one bin.
#[derive(Debug, Clone, Copy)]
struct Cell {
    count: u64,
    sum: f64,
    least: f64,
    largest: f64,
}

impl Cell {
    const EMPTY: Self = Self { count: 0, sum: 0.0, least: f64::INFINITY, largest: f64::NEG_INFINITY };

    fn join(&mut self, other: &Self) {
        self.count += other.count;
        self.sum += other.sum;
        self.least = self.least.min(other.least);
        self.largest = self.largest.max(other.largest);
    }
}

impl<const C: usize> Bin<C> {
    fn join(&mut self, other: &Self) {
        self.last_us = other.last_us;
        self.cells.iter_mut().zip(&other.cells).for_each(|(cell, other)| cell.join(other));
    }

    /// Its middle, s.
    pub fn time_s(&self) -> f64 {
        (self.first_us as f64 + self.last_us as f64) / 2e6
    }

    /// Mean of a channel; `None` where it had no value.
    pub fn mean(&self, channel: usize) -> Option<f64> {
        let cell = self.cells.get(channel).filter(|cell| cell.count > 0)?;
        Some(cell.sum / cell.count as f64)
    }

    /// Least and largest value of a channel; `None` where it had no value.
    pub fn range(&self, channel: usize) -> Option<[f64; 2]> {
        let cell = self.cells.get(channel).filter(|cell| cell.count > 0)?;
        Some([cell.least, cell.largest])
    }
}

impl<const C: usize> Timeline<C> {
    pub fn new(kept: usize) -> Self {
        Self { kept, bins: Vec::new(), rows_per_bin: 1, rows_in_last: 1 }
    }

    pub fn bins(&self) -> &[Bin<C>] {
        &self.bins
    }

    /// Adds a row. When there are too many bins, each joins its neighbour.
    pub fn add(&mut self, time_us: u64, values: [Option<f64>; C]) {
        let cells = values.map(|value| {
            value.map_or(Cell::EMPTY, |value| Cell { count: 1, sum: value, least: value, largest: value })
        });
        let row = Bin { first_us: time_us, last_us: time_us, cells };
        match self.bins.last_mut() {
            Some(last) if self.rows_in_last < self.rows_per_bin => {
                last.join(&row);
                self.rows_in_last += 1;
            }
            _ => {
                if self.bins.len() == 2 * self.kept {
                    self.halve();
                }
                self.bins.push(row);
                self.rows_in_last = 1;
            }
        }
    }

    /// Makes one bin of two.
    pub fn halve(&mut self) {
        let pairs = self.bins.chunks(2).filter_map(|pair| {
            let (first, others) = pair.split_first()?;
            let mut joined = *first;
            for other in others {
                joined.join(other);
            }
            Some(joined)
        });
        self.bins = pairs.collect();
        self.rows_per_bin *= 2;
    }
}

/// DecimatedItems items: all at first, then every second, every fourth and so on, so that between `kept` and twice as many remain.
#[derive(Debug, Clone)]
pub struct DecimatedItems<T> {
    kept: usize,
    items: Vec<T>,
    every: u64,
    seen: u64,
}

impl<T> DecimatedItems<T> {
    pub fn new(kept: usize) -> Self {
        Self { kept, items: Vec::new(), every: 1, seen: 0 }
    }

    pub fn items(&self) -> &[T] {
        &self.items
    }

    /// Adds an item, which is made only where it is kept.
    pub fn add(&mut self, item: impl FnOnce() -> T) {
        let place = self.seen;
        self.seen += 1;
        if !place.is_multiple_of(self.every) {
            return;
        }
        if self.items.len() == 2 * self.kept {
            let mut keep = [true, false].into_iter().cycle();
            self.items.retain(|_| keep.next() == Some(true));
            self.every *= 2;
        }
        self.items.push(item());
    }
}

#[cfg(test)]
mod tests {
    use super::{Bin, DecimatedItems, Timeline};

    const KEPT: usize = 256;

    #[test]
    fn a_peak_outlives_any_number_of_rows() {
        let mut timeline = Timeline::new(KEPT);
        for row in 0..100_000_u64 {
            timeline.add(row * 1000, [Some(if row == 54_321 { 99.0 } else { 1.0 }), None]);
        }
        let bins = timeline.bins();
        assert!((KEPT..=2 * KEPT).contains(&bins.len()));
        let peaks: Vec<f64> = bins.iter().filter(|bin| bin.range(0) == Some([1.0, 99.0])).map(Bin::time_s).collect();
        assert!(matches!(peaks[..], [peak_s] if (peak_s - 54.321).abs() < 0.3), "{peaks:?}");
        assert!(bins.iter().all(|bin| bin.range(1).is_none() && bin.mean(1).is_none()));
    }

    #[test]
    fn no_row_is_lost_or_counted_twice() {
        let mut timeline = Timeline::new(KEPT);
        (0..5000_u64).for_each(|row| timeline.add(row, [Some(row as f64)]));
        let rows: u64 = timeline.bins().iter().map(|bin| bin.cells[0].count).sum();
        let sum: f64 = timeline.bins().iter().map(|bin| bin.cells[0].sum).sum();
        assert_eq!((rows, sum), (5000, 4999.0 * 5000.0 / 2.0));
    }

    #[test]
    fn decimated_items_are_evenly_spaced_from_the_first_to_near_the_last() {
        let mut decimated = DecimatedItems::new(KEPT);
        (0..5000_u64).for_each(|item| decimated.add(|| item));
        let items = decimated.items();
        assert!((KEPT..=2 * KEPT).contains(&items.len()));
        assert!(items.iter().enumerate().all(|(i, item)| *item == 16 * i as u64), "{items:?}");
        assert_eq!(items.last(), Some(&4992));
    }
}
