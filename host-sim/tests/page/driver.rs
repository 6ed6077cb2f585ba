//! A browser without a window, driven by the `WebDriver` protocol.

use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::sleep;
use std::time::{Duration, Instant};

use base64::Engine as _;
use serde_json::{Value, json};

/// Chromium in turn: several at once would slow each other below what the tests ask.
static TURN: Mutex<()> = Mutex::new(());

/// How long something that must come is waited for: much longer than it takes, because the machine may be busy.
pub(crate) const PATIENCE: Duration = Duration::from_secs(40);

/// A session of a browser; both end when dropped.
pub(crate) struct Browser {
    driver: Child,
    agent: ureq::Agent,
    session: String,
    _turn: MutexGuard<'static, ()>,
}

impl Browser {
    /// Starts a browser that reaches nothing but this machine.
    pub(crate) fn start(width: u32, height: u32) -> Self {
        let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
        let missing = "chromedriver does not start; `cargo xtask setup` installs it";
        let mut driver = Command::new("chromedriver")
            .arg("--port=0")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect(missing);
        let mut lines = BufReader::new(driver.stdout.take().expect(missing)).lines();
        let port = lines
            .find_map(|line| {
                line.ok()?.split("successfully on port ").nth(1)?.trim_end_matches('.').parse::<u16>().ok()
            })
            .expect(missing);
        // Whatever else it says is read, so that it never waits for us.
        std::thread::spawn(move || lines.for_each(drop));
        let config = ureq::Agent::config_builder().timeout_global(Some(Duration::from_mins(1)));
        let agent = ureq::Agent::new_with_config(config.http_status_as_error(false).build());
        let mut browser =
            Self { driver, agent, session: format!("http://127.0.0.1:{port}/session"), _turn: turn };
        let options = [
            "--headless=new".to_owned(),
            // As root, as in most containers, Chromium does not start with it.
            "--no-sandbox".into(),
            "--disable-gpu".into(),
            "--disable-dev-shm-usage".into(),
            "--hide-scrollbars".into(),
            "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1".into(),
            format!("--window-size={width},{height}"),
        ];
        let answer = browser.post(
            "",
            &json!({"capabilities": {"alwaysMatch": {
                "goog:chromeOptions": {"args": options},
                "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"},
            }}}),
        );
        let id = answer["sessionId"].as_str().unwrap_or_else(|| panic!("no session: {answer}"));
        browser.session = format!("{}/{id}", browser.session);
        browser
    }

    fn post(&self, path: &str, body: &Value) -> Value {
        let link = format!("{}{path}", self.session);
        let mut answer = self
            .agent
            .post(&link)
            .header("Content-Type", "application/json")
            .send(body.to_string())
            .unwrap_or_else(|error| panic!("{link}: {error}"));
        let text = answer.body_mut().read_to_string().unwrap_or_else(|error| panic!("{link}: {error}"));
        let value: Value = serde_json::from_str(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert!(value["value"]["error"].is_null(), "{link}: {}", value["value"]);
        value["value"].clone()
    }

    /// Opens a page.
    pub(crate) fn open(&self, link: &str) {
        self.post("/url", &json!({"url": link}));
    }

    /// Runs a script's body in the page and returns what it returns.
    pub(crate) fn run(&self, script: &str) -> Value {
        self.post("/execute/sync", &json!({"script": script, "args": []}))
    }

    /// Waits until a script returns true.
    #[track_caller]
    pub(crate) fn wait(&self, what: &str, script: &str) {
        let until = Instant::now() + PATIENCE;
        while self.run(script) != Value::Bool(true) {
            assert!(
                Instant::now() < until,
                "never: {what}; the page says {}",
                self.run("return document.body.innerText")
            );
            sleep(Duration::from_millis(50));
        }
    }

    /// Presses keys while the element of `selector` has the focus.
    pub(crate) fn press(&self, selector: &str, keys: &str) {
        let found = self.post("/element", &json!({"using": "css selector", "value": selector}));
        let id = found.as_object().and_then(|map| map.values().next()?.as_str()).expect("an element");
        self.post(&format!("/element/{id}/value"), &json!({"text": keys}));
    }

    /// Chooses the option of a list by what it says.
    pub(crate) fn choose(&self, selector: &str, option: &str) {
        let script = format!(
            "const list = document.querySelector('{selector}');
             const option = [...list.options].find(one => one.textContent.startsWith('{option}'));
             list.value = option.value; list.dispatchEvent(new Event('change')); return true"
        );
        assert_eq!(self.run(&script), Value::Bool(true));
    }

    /// Clicks the element of `selector`.
    pub(crate) fn click(&self, selector: &str) {
        let found = self.post("/element", &json!({"using": "css selector", "value": selector}));
        let id = found.as_object().and_then(|map| map.values().next()?.as_str()).expect("an element");
        self.post(&format!("/element/{id}/click"), &json!({}));
    }

    /// Asks for light or dark pages.
    pub(crate) fn prefer(&self, scheme: &str) {
        self.prefer_all(&[("prefers-color-scheme", scheme)]);
    }

    /// Asks for what a person may prefer: features of media queries with their values.
    pub(crate) fn prefer_all(&self, wishes: &[(&str, &str)]) {
        let features: Vec<_> =
            wishes.iter().map(|(name, value)| json!({"name": name, "value": value})).collect();
        self.devtools("Emulation.setEmulatedMedia", &json!({"features": features}));
    }

    /// A command of the browser's own protocol.
    pub(crate) fn devtools(&self, command: &str, params: &Value) -> Value {
        self.post("/goog/cdp/execute", &json!({"cmd": command, "params": params}))
    }

    /// Presses a key wherever the focus is.
    pub(crate) fn key(&self, key: &str) {
        let actions = json!([{"type": "keyDown", "value": key}, {"type": "keyUp", "value": key}]);
        self.post("/actions", &json!({"actions": [{"type": "key", "id": "keys", "actions": actions}]}));
    }

    /// What was written to the console since the last call, with its level.
    pub(crate) fn console(&self) -> Vec<(String, String)> {
        let entries = self.post("/se/log", &json!({"type": "browser"}));
        let text = |entry: &Value, key: &str| entry[key].as_str().unwrap_or_default().to_owned();
        entries.as_array().map_or(Vec::new(), |list| {
            list.iter().map(|entry| (text(entry, "level"), text(entry, "message"))).collect()
        })
    }

    /// Addresses of all requests since the last call.
    pub(crate) fn requests(&self) -> Vec<String> {
        let entries = self.post("/se/log", &json!({"type": "performance"}));
        let of = |entry: &Value| {
            let message: Value = serde_json::from_str(entry["message"].as_str()?).ok()?;
            let message = &message["message"];
            let sent = matches!(
                message["method"].as_str()?,
                "Network.requestWillBeSent" | "Network.webSocketCreated"
            );
            let params = &message["params"];
            let link = params["request"]["url"].as_str().or(params["url"].as_str());
            if sent { link.map(str::to_owned) } else { None }
        };
        entries.as_array().map_or(Vec::new(), |list| list.iter().filter_map(of).collect())
    }

    /// A picture of the window as PNG.
    pub(crate) fn picture(&self) -> Vec<u8> {
        let link = format!("{}/screenshot", self.session);
        let mut answer = self.agent.get(&link).call().expect("the browser takes a picture");
        let value: Value = answer
            .body_mut()
            .with_config()
            .limit(64 << 20)
            .read_to_string()
            .map(|text| serde_json::from_str(&text).expect("JSON"))
            .expect("a picture");
        let text = value["value"].as_str().expect("a picture");
        base64::engine::general_purpose::STANDARD.decode(text).expect("base64")
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.agent.delete(&self.session).call();
        let _ = self.driver.kill();
        let _ = self.driver.wait();
    }
}
