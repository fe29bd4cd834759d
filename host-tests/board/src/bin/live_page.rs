//! Speed of the live page in headless Chromium on this machine: time until it is live, frames a second with ten minutes of
//! history, and latency from a sample to the screen. There are no limits: the figures depend on the machine as much as on the page.

#[cfg(unix)]
mod figures {
    use std::collections::VecDeque;
    use std::io;
    use std::path::Path;
    use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
    use std::time::{Duration, Instant};

    use board_tests::browser::{Browser, MonitorRun};
    use board_tests::{UART, firmware, machine};
    use proprio_link::{Link, LinkError, Source, Transport};
    use proprio_monitor::{Monitor, Options};
    use proprio_session::LoadedTable;
    use rig_twin::Scenario;
    use virtual_due::{CYCLES_PER_SECOND, WiredRig};

    const LIVE: &str = "document.getElementById('arm-values')?.textContent.startsWith('tip x') ?? false";
    /// History that the page has, s.
    const HISTORY_S: u64 = 600;

    pub fn print() {
        start();
        let table = table();
        let folder = tempfile::tempdir().expect("there is room for a temporary folder");
        let options = Options {
            port: 0,
            table: Some(LoadedTable::load(&table).expect("the reference table")),
            folder: folder.path().to_owned(),
            token: None,
            session: None,
            runtime_folder: None,
            stream: None,
            help: ToString::to_string,
            finding_text: ToString::to_string,
        };
        let live = Link::start(Box::new(Due), None).expect("it is there");
        let monitor = Monitor::start(Some(live), options).expect("a free port");
        for (name, size) in [("1400 × 1000", [1400, 1000]), ("phone, 390 × 844", [390, 844])] {
            let mut browser = Browser::start();
            browser.screen(size, "light");
            browser.open(&format!("http://{}/", monitor.address()));
            browser.wait_for("/ ([3-9]\\d|\\d{3})\\d{3} rows/.test(document.getElementById('fact-page').textContent)");
            for span in ["600", "30"] {
                browser.value(&format!(
                    "{{ const span = document.getElementById('span'); span.value = '{span}'; span.dispatchEvent(new Event('change')) }}"
                ));
                frames(&mut browser, name, span);
            }
            latency(&mut browser);
        }
    }

    fn table() -> std::path::PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../calibration-tables/planar-6.toml")
    }

    /// Measures the time from the start of the monitor to the arm on the screen; the browser runs already.
    fn start() {
        // Built before the time is taken.
        firmware();
        let mut browser = Browser::start();
        let mut times: Vec<f64> = (0..5)
            .map(|_| {
                let began = Instant::now();
                let run = MonitorRun::live(&[]);
                browser.open(&run.address);
                browser.wait_for(LIVE);
                let took = began.elapsed().as_secs_f64();
                browser.open("about:blank");
                took
            })
            .collect();
        times.sort_by(f64::total_cmp);
        println!(
            "page live after the start of virtual Due and monitor: {:.2} s median, {:.2} s longest of 5",
            times[2], times[4]
        );
    }

    fn frames(browser: &mut Browser, name: &str, span: &str) {
        std::thread::sleep(Duration::from_secs(3));
        let mut rates = Vec::new();
        for _ in 0..20 {
            std::thread::sleep(Duration::from_secs(1));
            let text = browser.text("fact-page");
            rates.push(text.split(' ').next().and_then(|rate| rate.parse::<u32>().ok()).unwrap_or_default());
        }
        rates.sort_unstable();
        let rows = browser.text("fact-page");
        println!("{name}, {span} s seen: {} frames/s median, {} least of 20 s ({rows})", rates[10], rates[0]);
    }

    /// Latency of the last 3000 pictures of this browser.
    fn latency(browser: &mut Browser) {
        println!("    sample to screen: {}", browser.text("fact-latency"));
    }

    /// The virtual Due in a thread of this process: its first minutes as fast as possible, then in real time.
    struct Due;

    /// Its serial line.
    struct Line {
        output: Receiver<Vec<u8>>,
        input: Sender<Vec<u8>>,
        rest: VecDeque<u8>,
    }

    impl Source for Due {
        fn open(&mut self) -> Result<(String, Box<dyn Transport>), LinkError> {
            // A little ahead of its reader and no more, so that nothing is dropped.
            let (sender, output) = sync_channel(1);
            let (input, receiver) = channel();
            std::thread::spawn(move || run(&sender, &receiver));
            Ok(("virtual Due, ten minutes old".to_owned(), Box::new(Line { output, input, rest: VecDeque::new() })))
        }

        fn can_reconnect(&self) -> bool {
            false
        }
    }

    fn run(output: &SyncSender<Vec<u8>>, input: &Receiver<Vec<u8>>) {
        let mut machine = machine(WiredRig::new(Scenario::FreeSwing, 1));
        let history = HISTORY_S * CYCLES_PER_SECOND;
        let mut began = None;
        loop {
            let end = if machine.now() < history {
                machine.now() + CYCLES_PER_SECOND / 50
            } else {
                std::thread::sleep(Duration::from_millis(2));
                let began = *began.get_or_insert_with(Instant::now);
                history + (began.elapsed().as_secs_f64() * CYCLES_PER_SECOND as f64) as u64
            };
            for bytes in input.try_iter() {
                let now = machine.now();
                machine.world_mut().send(UART, &bytes, now);
            }
            machine.run_until(end);
            let bytes: Vec<u8> = machine.world_mut().take_transmitted(UART).into_iter().map(|(_, byte)| byte).collect();
            if !bytes.is_empty() && output.send(bytes).is_err() {
                return;
            }
        }
    }

    impl Transport for Line {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            if self.rest.is_empty() {
                self.rest.extend(self.output.recv_timeout(Duration::from_millis(10)).unwrap_or_default());
            }
            let count = self.rest.len().min(buffer.len());
            buffer.iter_mut().zip(self.rest.drain(..count)).for_each(|(place, byte)| *place = byte);
            Ok(count)
        }

        fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
            self.input.send(bytes.to_vec()).map_err(io::Error::other)
        }
    }
}

fn main() {
    #[cfg(unix)]
    figures::print();
}
