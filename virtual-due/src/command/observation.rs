//! Verdict of a run, by texts in its serial output and by reports.

use clap::Args;

/// Options that end a run, or make it a failure.
#[derive(Debug, Clone, Default, Args)]
pub struct Expectations {
    /// End the run with success as soon as the serial output holds this text; a run that ends without it has failed.
    #[arg(long, value_name = "TEXT")]
    pub until: Option<String>,
    /// End the run as a failure as soon as the serial output holds this text.
    #[arg(long, value_name = "TEXT")]
    pub fail_on: Option<String>,
    /// End the run as a failure at the first report: the firmware did what the emulated board does not model, or what the
    /// datasheet forbids.
    #[arg(long)]
    pub strict: bool,
}

/// Verdict of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Verdict {
    /// The text of `--until` was sent.
    Reached,
    /// The run has failed, for this reason.
    Failed(String),
}

/// Observer of a run.
#[derive(Debug, Default)]
pub struct Observer {
    until: Option<Search>,
    fail_on: Option<Search>,
    strict: bool,
    verdict: Option<Verdict>,
}

impl Observer {
    /// An observer for these expectations.
    pub fn new(expectations: &Expectations) -> Self {
        let search = |text: &Option<String>| text.as_deref().map(Search::new);
        let Expectations { until, fail_on, strict } = expectations;
        Self { until: search(until), fail_on: search(fail_on), strict: *strict, verdict: None }
    }

    /// Searches bytes of the serial output, in their order.
    pub fn sent(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if let Some(search) = &mut self.fail_on
                && search.is_completed_by(*byte)
            {
                let text = &search.text;
                let reason = format!("the serial output holds {text:?}, the text of --fail-on");
                self.verdict.get_or_insert(Verdict::Failed(reason));
            }
            if self.until.as_mut().is_some_and(|search| search.is_completed_by(*byte)) {
                self.verdict.get_or_insert(Verdict::Reached);
            }
        }
    }

    /// Takes notice of a report.
    pub fn reported(&mut self) {
        if self.strict {
            let reason = "the emulated board has a report, and --strict was given";
            self.verdict.get_or_insert(Verdict::Failed(reason.to_owned()));
        }
    }

    /// The verdict that ends the run, if there is one.
    pub fn verdict(&self) -> Option<&Verdict> {
        self.verdict.as_ref()
    }

    /// The verdict at the end of the run.
    pub fn final_verdict(&self) -> Verdict {
        match (&self.verdict, &self.until) {
            (Some(verdict), _) => verdict.clone(),
            (None, Some(Search { text, .. })) => {
                Verdict::Failed(format!("the serial output did not hold {text:?}, the text of --until"))
            }
            (None, None) => Verdict::Reached,
        }
    }
}

/// A search for a text in bytes that come one by one.
#[derive(Debug)]
struct Search {
    text: String,
    /// The last bytes, no more than the text has.
    last: Vec<u8>,
}

impl Search {
    fn new(text: &str) -> Self {
        Self { text: text.to_owned(), last: Vec::new() }
    }

    /// True if the text ends with this byte.
    fn is_completed_by(&mut self, byte: u8) -> bool {
        self.last.push(byte);
        if self.last.len() > self.text.len() {
            self.last.remove(0);
        }
        self.last == self.text.as_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::{Expectations, Observer, Verdict};

    fn observer(until: &str, fail_on: &str) -> Observer {
        let text = |text: &str| Some(text.to_owned()).filter(|text| !text.is_empty());
        Observer::new(&Expectations { until: text(until), fail_on: text(fail_on), strict: false })
    }

    #[test]
    fn text_is_found_across_the_pieces_of_the_output() {
        let mut observer = observer("aab", "");
        observer.sent(b"xaa");
        assert_eq!(observer.verdict(), None);
        observer.sent(b"aby");
        assert_eq!(observer.verdict(), Some(&Verdict::Reached));
    }

    #[test]
    fn first_text_of_the_output_decides() {
        let mut first = observer("done", "FAIL");
        first.sent(b"FAIL done");
        assert!(matches!(first.final_verdict(), Verdict::Failed(_)));
        let mut last = observer("done", "FAIL");
        last.sent(b"done FAIL");
        assert_eq!(last.final_verdict(), Verdict::Reached);
    }

    #[test]
    fn run_without_its_text_has_failed() {
        let mut observer = observer("done", "");
        observer.sent(b"don");
        assert!(matches!(observer.final_verdict(), Verdict::Failed(reason) if reason.contains("\"done\"")));
    }
}
