//! Contact detection: false alarms of free arms, and detected contacts.

use std::fmt::{self, Write};

use crate::arm::SESSION_S;
use crate::family::{Contact, DEVELOPMENT, Family, REFERENCE, TEST};
use crate::motions::Motions;
use crate::rigs::Rigs;

/// The section.
pub fn write(page: &mut String, family: &Family, motions: &Motions, rigs: Option<&Rigs>) -> fmt::Result {
    writeln!(page, "{CONTACT}")?;
    writeln!(page, "| arms | false alarms | an hour | pushes found | encounters found |\n|---|---|---|---|---|")?;
    let groups: [(&str, &[u64]); 3] = [("test", &TEST), ("development", &DEVELOPMENT), ("reference", &[REFERENCE])];
    for (name, seeds) in groups {
        let mut sum = Contact::default();
        for arm in family.of(seeds) {
            sum.false_alarms += arm.contact.false_alarms;
            sum.pushes += arm.contact.pushes;
            sum.encounters += arm.contact.encounters;
        }
        let alarms = alarms(sum.false_alarms, seeds.len() as f64 * SESSION_S);
        let Contact { pushes, encounters, .. } = sum;
        writeln!(
            page,
            "| {name} | {alarms} | {} of {} | {} of {} |",
            pushes.found, pushes.all, encounters.found, encounters.all
        )?;
    }
    writeln!(page, "\n{FREE}")?;
    writeln!(page, "| free motion | false alarms | an hour |\n|---|---|---|")?;
    for (name, count, seconds) in motions.false_alarms() {
        writeln!(page, "| {name} | {} |", alarms(count, seconds))?;
    }
    for (name, count, seconds) in rigs.into_iter().flat_map(Rigs::false_alarms) {
        writeln!(page, "| {name} | {} |", alarms(count, seconds))?;
    }
    writeln!(page)
}

/// Two cells: the number, and the rate.
fn alarms(count: usize, seconds: f64) -> String {
    format!("{count} in {:.0} min | {:.1}", seconds / 60.0, count as f64 * 3600.0 / seconds)
}

const CONTACT: &str = "\
### Contact

False alarms: contacts of the free arm (scenario I). Pushes over 10° that are detected on their segment within 0.5 s of the first touch
(scenario II). Encounters in which the obstacle bends a segment by over 10°, detected on any segment within 0.5 s (scenario III).
";

const FREE: &str = "\
False alarms in the other free motions of four of the test arms, and in the free sessions of the arms of other simulators:
";
