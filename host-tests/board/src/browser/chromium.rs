//! Chromium without a window, over its DevTools protocol (<https://chromedevtools.github.io/devtools-protocol>).

use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use std::{env, fs};

use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::stream::MaybeTlsStream;
use tungstenite::{Message, WebSocket};

/// Longest time to wait for anything.
const TIMEOUT: Duration = Duration::from_mins(1);

/// A browser with one page.
pub struct Browser {
    process: Child,
    socket: WebSocket<MaybeTlsStream<TcpStream>>,
    last_id: u64,
    session: String,
    /// Errors of scripts, and messages of the console.
    pub errors: Vec<String>,
    /// Folder of its profile and its downloads.
    pub folder: TempDir,
}

impl Browser {
    /// Starts it with an empty page.
    ///
    /// # Panics
    /// If there is no Chromium.
    #[must_use]
    pub fn start() -> Self {
        let folder = tempfile::tempdir().expect("there is room for a temporary folder");
        let program = env::var_os("CHROMIUM").unwrap_or_else(|| "chromium".into());
        let mut command = Command::new(&program);
        // A container has neither users nor much shared memory for it.
        command.args(["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--remote-debugging-port=0"]);
        command.arg(format!("--user-data-dir={}", folder.path().display())).arg("about:blank");
        let mut process = command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn();
        let process_ref = process.as_mut().unwrap_or_else(|error| panic!("{}: {error}", program.display()));
        let mut lines = BufReader::new(process_ref.stderr.take().expect("a pipe")).lines().map_while(Result::ok);
        let address = lines.find_map(|line| line.strip_prefix("DevTools listening on ").map(str::to_owned));
        let address = address.expect("the browser prints where it listens");
        std::thread::spawn(move || lines.for_each(drop));
        let (socket, _) = tungstenite::connect(&address).expect("it listens");
        if let MaybeTlsStream::Plain(stream) = socket.get_ref() {
            stream.set_read_timeout(Some(TIMEOUT)).expect("a timeout");
        }
        let process = process.expect("it was looked at");
        let mut browser = Self { process, socket, last_id: 0, session: String::new(), errors: Vec::new(), folder };
        let target = browser.call("Target.createTarget", &json!({"url": "about:blank"}))["targetId"].clone();
        let attached = browser.call("Target.attachToTarget", &json!({"targetId": target, "flatten": true}));
        attached["sessionId"].as_str().expect("a session").clone_into(&mut browser.session);
        for domain in ["Page", "Runtime", "Log"] {
            browser.call(&format!("{domain}.enable"), &json!({}));
        }
        let downloads = browser.folder.path().join("downloads").display().to_string();
        browser.call("Browser.setDownloadBehavior", &json!({"behavior": "allow", "downloadPath": downloads}));
        browser
    }

    /// Calls a method; returns its result.
    ///
    /// # Panics
    /// If the browser has ended, or refuses.
    pub fn call(&mut self, method: &str, params: &Value) -> Value {
        self.last_id += 1;
        let mut call = json!({"id": self.last_id, "method": method, "params": params});
        if !self.session.is_empty() {
            call["sessionId"] = self.session.clone().into();
        }
        self.socket.send(Message::from(call.to_string())).expect("it runs");
        loop {
            let Message::Text(text) = self.socket.read().expect("it runs") else { continue };
            let mut message: Value = serde_json::from_str(&text).expect("the browser sends JSON");
            if message["id"] == self.last_id {
                assert!(message["error"].is_null(), "{method}: {}", message["error"]);
                return message["result"].take();
            }
            if let Some("Runtime.exceptionThrown" | "Log.entryAdded") = message["method"].as_str() {
                self.errors.push(message["params"].to_string());
            }
        }
    }

    /// Sets the size of the screen, and light or dark.
    pub fn screen(&mut self, [width, height]: [u32; 2], scheme: &str) {
        let metrics = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": width < 600});
        self.call("Emulation.setDeviceMetricsOverride", &metrics);
        let features = json!([{"name": "prefers-color-scheme", "value": scheme}]);
        self.call("Emulation.setEmulatedMedia", &json!({"features": features}));
    }

    /// Opens a page, and waits until it is complete.
    pub fn open(&mut self, address: &str) {
        self.call("Page.navigate", &json!({"url": address}));
        let page = address.split('#').next().unwrap_or_default();
        self.wait_for(&format!("document.readyState === 'complete' && document.URL.startsWith('{page}')"));
    }

    /// Evaluates an expression of JavaScript; of a promise, its result.
    ///
    /// # Panics
    /// If the expression throws.
    pub fn value(&mut self, expression: &str) -> Value {
        let params = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let mut result = self.call("Runtime.evaluate", &params);
        assert!(result["exceptionDetails"].is_null(), "{expression}: {result}");
        result["result"]["value"].take()
    }

    /// The text of the element with this id.
    pub fn text(&mut self, id: &str) -> String {
        let text = self.value(&format!("document.getElementById('{id}')?.textContent ?? ''"));
        text.as_str().unwrap_or_default().to_owned()
    }

    /// Waits until an expression is true; returns the time that it took.
    ///
    /// # Panics
    /// If it is not true within a minute.
    pub fn wait_for(&mut self, expression: &str) -> Duration {
        let start = Instant::now();
        while self.value(expression) != true {
            assert!(start.elapsed() < TIMEOUT, "{expression} never came; {:?}", self.errors);
            std::thread::sleep(Duration::from_millis(10));
        }
        start.elapsed()
    }

    /// Presses and lets go of a key.
    pub fn press(&mut self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            let text = if kind == "keyDown" && key.chars().count() == 1 { key } else { "" };
            self.call("Input.dispatchKeyEvent", &json!({"type": kind, "key": key, "text": text}));
        }
    }

    /// Waits for a download whose name has this ending; returns its name and content.
    ///
    /// # Panics
    /// If it is missing after a minute.
    pub fn download(&mut self, ending: &str) -> (String, Vec<u8>) {
        let folder = self.folder.path().join("downloads");
        let start = Instant::now();
        loop {
            let files = fs::read_dir(&folder).into_iter().flatten().flatten();
            let mut names = files.filter_map(|file| file.file_name().into_string().ok());
            if let Some(name) = names.find(|name| name.ends_with(ending)) {
                let content = fs::read(folder.join(&name)).expect("it is there");
                return (name, content);
            }
            assert!(start.elapsed() < TIMEOUT, "no {ending} was downloaded; {:?}", self.errors);
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Moves the mouse to a place in the window, pixels.
    pub fn point(&mut self, [x, y]: [f64; 2]) {
        self.call("Input.dispatchMouseEvent", &json!({"type": "mouseMoved", "x": x, "y": y}));
    }

    /// Clicks at a place in the window, pixels.
    pub fn click(&mut self, [x, y]: [f64; 2]) {
        for kind in ["mousePressed", "mouseReleased"] {
            let event = json!({"type": kind, "x": x, "y": y, "button": "left", "clickCount": 1});
            self.call("Input.dispatchMouseEvent", &event);
        }
    }

    /// Puts a finger on a place in the window, pixels, or takes it away.
    pub fn touch(&mut self, place: Option<[f64; 2]>) {
        let points: Vec<Value> = place.iter().map(|[x, y]| json!({"x": x, "y": y})).collect();
        let kind = if place.is_some() { "touchStart" } else { "touchEnd" };
        self.call("Input.dispatchTouchEvent", &json!({"type": kind, "touchPoints": points}));
    }

    /// A place in an element, which an expression of JavaScript selects, at shares of its width and height.
    ///
    /// # Panics
    /// If there is no such element.
    pub fn place(&mut self, element: &str, [across, down]: [f64; 2]) -> [f64; 2] {
        let place = self.value(&format!(
            "(({{x, y, width, height}}) => [x + width * {across}, y + height * {down}])({element}.getBoundingClientRect())"
        ));
        [0, 1].map(|i| place[i].as_f64().expect("a number"))
    }

    /// Writes a picture of the whole page to `target/browser`.
    ///
    /// # Panics
    /// If it cannot be written.
    pub fn picture(&mut self, name: &str) {
        self.capture(name, &json!({"format": "png", "captureBeyondViewport": true}));
    }

    /// Leaves a picture of the visible part of the page in `target/browser`.
    ///
    /// # Panics
    /// If it cannot be written.
    pub fn picture_of_screen(&mut self, name: &str) {
        self.capture(name, &json!({"format": "png"}));
    }

    /// Leaves a picture of one element, which an expression of JavaScript selects, in `target/browser`.
    ///
    /// # Panics
    /// If there is no such element, or the picture cannot be written.
    pub fn picture_of(&mut self, name: &str, element: &str) {
        let rectangle = self.value(&format!(
            "(({{x, y, width, height}}) => ({{x: x + scrollX, y: y + scrollY, width, height, scale: 1}}))\
             ({element}.getBoundingClientRect())"
        ));
        self.capture(name, &json!({"format": "png", "captureBeyondViewport": true, "clip": rectangle}));
    }

    fn capture(&mut self, name: &str, parameters: &Value) {
        let picture = self.call("Page.captureScreenshot", parameters);
        // target/debug/deps/browser-…
        let own = env::current_exe().expect("the program's own path");
        let target = own.ancestors().nth(3).expect("cargo's folder").join("browser");
        fs::create_dir_all(&target).expect("cargo's folder can be written to");
        let picture = BASE64_STANDARD.decode(picture["data"].as_str().expect("a picture")).expect("a picture");
        fs::write(target.join(name), picture).expect("there is room");
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // Its helpers end with it.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
