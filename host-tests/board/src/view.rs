//! Estimate and truth in a terminal.

use std::io::{IsTerminal, Write, stdout};

use estimator_core::Q;
use telemetry::SegmentEstimate;

use crate::board::Board;

/// Comparisons for each printed line where the output is not a terminal.
const LOOKS_PER_LINE: u64 = 100;

/// Display of the run: in a terminal a block that is redrawn in place, else a line every 10 s.
pub struct View {
    seconds: u64,
    looks: u64,
    drawn_lines: usize,
}

impl View {
    /// For a run of some seconds.
    #[must_use]
    pub const fn new(seconds: u64) -> Self {
        Self { seconds, looks: 0, drawn_lines: 0 }
    }

    /// Shows the board's last estimate and the truth of the same tick.
    pub fn show(&mut self, board: &Board) {
        self.looks += 1;
        let Some(estimate) = board.estimates().next_back() else { return };
        let (Some(truth), Some(tip)) = (board.truths().get(estimate.tick as usize), estimate.segments[5]) else {
            return;
        };
        let error_mm = (mm(tip.end[0]) - truth[5].x_m * 1e3).hypot(mm(tip.end[1]) - truth[5].y_m * 1e3);
        let time_s = f64::from(estimate.tick) / 100.0;
        if !stdout().is_terminal() {
            if self.looks.is_multiple_of(LOOKS_PER_LINE) {
                println!("{time_s:6.1} s of {}: tip {error_mm:5.1} mm from the truth", self.seconds);
            }
            return;
        }
        let mut lines = vec![
            format!("virtual Due, scenario I, {time_s:6.1} s of {}", self.seconds),
            "          bend angle, °        end x, mm           end y, mm".to_owned(),
            "segment   estimate   truth     estimate   truth    estimate   truth".to_owned(),
        ];
        let mut before_rad = 0.0;
        for (number, (segment, truth)) in (1..).zip(estimate.segments.iter().zip(truth)) {
            let theta_deg = (truth.heading_rad - before_rad).to_degrees();
            before_rad = truth.heading_rad;
            let Some(segment) = segment else { continue };
            lines.push(row(number, segment, theta_deg, truth.x_m * 1e3, truth.y_m * 1e3));
        }
        lines.push(format!("tip {error_mm:.1} mm from the truth"));
        self.draw(&lines);
    }

    fn draw(&mut self, lines: &[String]) {
        if self.drawn_lines > 0 {
            // Up to the first line, and clear from there.
            print!("\x1b[{}A\x1b[J", self.drawn_lines);
        }
        println!("{}", lines.join("\n"));
        let _ = stdout().flush();
        self.drawn_lines = lines.len();
    }

    /// Leaves the last block on the screen.
    pub fn finish(&self) {
        println!();
    }
}

fn row(number: u32, segment: &SegmentEstimate, theta_deg: f64, x_mm: f64, y_mm: f64) -> String {
    let estimate_deg = Q::from_bits(segment.theta).to_f64().to_degrees();
    format!(
        "{number:7} {:10.1} {theta_deg:7.1}   {:10.1} {x_mm:7.1}  {:10.1} {y_mm:7.1}",
        estimate_deg,
        mm(segment.end[0]),
        mm(segment.end[1])
    )
}

/// A length in the estimator's bits, mm.
fn mm(bits: i32) -> f64 {
    Q::from_bits(bits).to_f64() * 1e3
}
