//! The V–Orient maps of the table with the data of the sessions.

use calibration_tables::{ArmFile, BendToml};
use estimator_core::{Method, VOLTS_PER_COUNT};
use proprio_session::{Row, SENSOR_NAMES};

use super::downsample::DecimatedItems;
use super::plot::{Axis, Colour, Figure, Marks, Panel, Series, Size, extent, padded, rounded, share_y};

/// Fewest readings of a sensor that are shown.
const READINGS: usize = 256;
/// Points of a drawn map.
const MAP_POINTS: u32 = 60;

/// Readings of all sensors with the true angle.
pub struct Readings(Vec<SensorReadings>);

struct SensorReadings {
    segment: usize,
    place: usize,
    map: BendToml,
    /// Volts and true angle, deg.
    points: DecimatedItems<(f64, f64)>,
    square_sum_deg2: f64,
    count: u64,
}

impl Readings {
    pub fn new(table: &ArmFile) -> Self {
        let sensors = table.segments.iter().enumerate().flat_map(|(segment, keys)| {
            let maps = keys.bend.iter().flatten().cloned().enumerate();
            maps.map(move |(place, map)| SensorReadings::new(segment, place, map))
        });
        Self(sensors.collect())
    }

    pub fn add(&mut self, row: &Row) {
        for sensor in &mut self.0 {
            let counts = row.sample.bend[sensor.segment][sensor.place];
            if let Some((counts, theta)) = counts.zip(row.true_theta(sensor.segment)) {
                sensor.add(f64::from(counts) * VOLTS_PER_COUNT, theta.to_degrees());
            }
        }
    }

    pub fn figure(&self) -> Figure {
        let samples = self.0.iter().map(|sensor| sensor.count).max().unwrap_or(0);
        let shown = self.0.iter().map(|sensor| sensor.points.items().len()).max().unwrap_or(0);
        let data = if samples == 0 {
            "No session has both readings and true headings, so that the maps stand alone.".to_owned()
        } else {
            format!(
                "Points: readings of all sessions with the true bend angle, up to {shown} of {samples} a sensor, evenly \
                 spaced in time. The RMSE is over all of them."
            )
        };
        let mut panels: Vec<Panel> = self.0.iter().map(SensorReadings::panel).collect();
        share_y(panels.iter_mut());
        Figure {
            name: "v_orient",
            title: "V–Orient maps",
            caption: format!(
                "Line: the table's map from a sensor's voltage to its segment's bend angle. {data} All panels have one scale of the \
                 angle."
            ),
            is_drawn: !panels.is_empty(),
            panels,
        }
    }
}

impl SensorReadings {
    fn new(segment: usize, place: usize, map: BendToml) -> Self {
        Self { segment, place, map, points: DecimatedItems::new(READINGS), square_sum_deg2: 0.0, count: 0 }
    }

    fn mapped_deg(&self, volts: f64) -> f64 {
        let BendToml { c0, c1, c2, .. } = self.map;
        ((c2 * volts + c1) * volts + c0).to_degrees()
    }

    fn add(&mut self, volts: f64, theta_deg: f64) {
        let error_deg = self.mapped_deg(volts) - theta_deg;
        self.square_sum_deg2 += error_deg * error_deg;
        self.count += 1;
        self.points.add(|| (volts, theta_deg));
    }

    fn panel(&self) -> Panel {
        let points: Vec<(f64, f64)> =
            self.points.items().iter().map(|(volts, deg)| (tens_of_microvolts(*volts), rounded(*deg))).collect();
        let data = Series {
            name: "true angle".to_owned(),
            colour: Colour::Of(Method::Bend),
            marks: Marks::Dots { x: "voltage_v", y: "theta_true_deg", points },
        };
        let [seen, _] = extent([&data]);
        let range = match (self.map.volts, self.count) {
            (Some([lo, hi]), 0) => [lo, hi],
            (Some([lo, hi]), _) => [lo.min(seen[0]), hi.max(seen[1])],
            (None, 0) => [0.0, 3.3],
            (None, _) => seen,
        };
        let at = |i: u32| range[0] + (range[1] - range[0]) * f64::from(i) / f64::from(MAP_POINTS);
        let curve =
            (0..=MAP_POINTS).map(|i| (tens_of_microvolts(at(i)), Some(rounded(self.mapped_deg(at(i)))))).collect();
        let map = Series {
            name: "map".to_owned(),
            colour: Colour::Ink,
            marks: Marks::Line { x: "voltage_v", y: "theta_mapped_deg", points: curve },
        };
        let series: Vec<Series> = [data, map].into_iter().skip(usize::from(self.count == 0)).collect();
        let [x, y] = extent(&series).map(padded);
        let [x, y] = [Axis::new("voltage, V", x), Axis::new("bend angle, deg", y)];
        let name = format!("bend{}{}", self.segment + 1, SENSOR_NAMES[self.place]);
        let here = (self.count > 0).then(|| (self.square_sum_deg2 / self.count as f64).sqrt());
        let facts = [("rmse_deg", here), ("calibration_rmse_deg", self.map.rmse_deg)];
        let title = match (here, self.map.rmse_deg) {
            (Some(here), Some(table)) => format!("{name}: RMSE {here:.1}°, in the calibration {table:.1}°"),
            (Some(here), None) => format!("{name}: RMSE {here:.1}°"),
            (None, Some(table)) => format!("{name}: RMSE in the calibration {table:.1}°"),
            (None, None) => name.clone(),
        };
        let facts = facts.into_iter().filter_map(|(name, value)| Some((name, rounded(value?)))).collect();
        Panel { session: None, name, title, facts, size: Size::Third, x, y, series }
    }
}

/// Rounds to 10 µV, a hundredth of a count.
fn tens_of_microvolts(volts: f64) -> f64 {
    (volts * 1e5).round() / 1e5
}
