//! A browser moved by Chromium's DevTools protocol, as a person would move it: pages, mouse, pictures, console.
//!
//! Messages are JSON and end with a zero byte. They go through the browser's file descriptors 3 and 4 (`--remote-debugging-pipe`),
//! which a shell makes of its standard input and output.

use core::time::Duration;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::Instant;

use anyhow::{Context, Result, bail, ensure};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

/// Longest time for one answer: software renders slowly.
const PATIENCE: Duration = Duration::from_secs(60);

/// A running browser with one page.
pub(crate) struct Browser {
    child: Child,
    input: ChildStdin,
    messages: Receiver<Value>,
    /// Of the page; empty before there is one.
    session: String,
    sent: u64,
    /// What the page said on its console, and errors that nobody caught.
    said: Vec<String>,
    loaded: bool,
}

impl Browser {
    /// Starts the browser with an empty page of this size, pixels; `profile` is a folder for what it keeps.
    pub(crate) fn start(program: &Path, profile: &Path, [width, height]: [u32; 2]) -> Result<Self> {
        let mut child = Command::new("sh")
            .args(["-c", "exec \"$0\" \"$@\" 3<&0 4>&1 </dev/null >/dev/null"])
            .arg(program)
            .args([
                "--headless",
                "--remote-debugging-pipe",
                "--no-sandbox",
                "--disable-gpu",
                "--use-angle=swiftshader",
                "--enable-unsafe-swiftshader",
                "--disable-quic",
                "--no-first-run",
                "--disable-background-networking",
                "--disable-component-update",
                "--disable-sync",
                "--hide-scrollbars",
            ])
            .arg(format!("--user-data-dir={}", profile.display()))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .with_context(|| format!("cannot start {}", program.display()))?;
        let input = child.stdin.take().context("no pipe to the browser")?;
        let output = child.stdout.take().context("no pipe from the browser")?;
        let (sender, messages) = channel();
        thread::spawn(move || {
            for message in BufReader::new(output).split(0) {
                let message = message.ok().and_then(|m| serde_json::from_slice(&m).ok());
                let Some(message) = message else { return };
                if sender.send(message).is_err() {
                    return;
                }
            }
        });
        let mut browser = Self {
            child,
            input,
            messages,
            session: String::new(),
            sent: 0,
            said: Vec::new(),
            loaded: false,
        };
        let page = browser.call("Target.createTarget", json!({ "url": "about:blank" }))?;
        let how = json!({ "targetId": page["targetId"], "flatten": true });
        let session = browser.call("Target.attachToTarget", how)?;
        let id = session["sessionId"].as_str().context("no session")?;
        browser.session = id.to_owned();
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            browser.call(domain, json!({}))?;
        }
        let size =
            json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        browser.call("Emulation.setDeviceMetricsOverride", size)?;
        Ok(browser)
    }

    /// Opens an address and waits until the page has loaded.
    pub(crate) fn open(&mut self, address: &str) -> Result<()> {
        self.loaded = false;
        let answer = self.call("Page.navigate", json!({ "url": address }))?;
        ensure!(
            answer["errorText"].is_null(),
            "{address}: {}",
            answer["errorText"]
        );
        let end = Instant::now() + PATIENCE;
        while !self.loaded {
            self.hear(end)?;
        }
        Ok(())
    }

    /// The value of an expression in the page.
    pub(crate) fn ask(&mut self, expression: &str) -> Result<Value> {
        let how = json!({ "expression": expression, "returnByValue": true });
        let answer = self.call("Runtime.evaluate", how)?;
        let failed = &answer["exceptionDetails"];
        ensure!(failed.is_null(), "{expression}: {failed}");
        Ok(answer["result"]["value"].clone())
    }

    /// Clicks the middle of the element with this id.
    pub(crate) fn click(&mut self, id: &str) -> Result<()> {
        let place = self.ask(&format!(
            "(r => [r.x + r.width / 2, r.y + r.height / 2])(document.getElementById('{id}').getBoundingClientRect())"
        ))?;
        for kind in ["mousePressed", "mouseReleased"] {
            let event = json!({ "type": kind, "x": place[0], "y": place[1], "button": "left", "clickCount": 1 });
            self.call("Input.dispatchMouseEvent", event)?;
        }
        Ok(())
    }

    /// The page as PNG.
    pub(crate) fn picture(&mut self) -> Result<Vec<u8>> {
        let answer = self.call("Page.captureScreenshot", json!({ "format": "png" }))?;
        let data = answer["data"].as_str().context("no picture")?;
        Ok(STANDARD.decode(data)?)
    }

    /// What the page has said on its console so far, and errors that nobody caught.
    pub(crate) fn console(&self) -> &[String] {
        &self.said
    }

    /// Calls a method and waits for its answer.
    fn call(&mut self, method: &str, parameters: Value) -> Result<Value> {
        self.sent += 1;
        let mut message = json!({ "id": self.sent, "method": method, "params": parameters });
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        let mut bytes = message.to_string().into_bytes();
        bytes.push(0);
        self.input.write_all(&bytes)?;
        self.input.flush()?;
        let end = Instant::now() + PATIENCE;
        loop {
            let message = self.hear(end).with_context(|| method.to_owned())?;
            if message["id"] == json!(self.sent) {
                let error = &message["error"];
                ensure!(error.is_null(), "{method}: {error}");
                return Ok(message["result"].clone());
            }
        }
    }

    /// The next message, noted where it is an event.
    fn hear(&mut self, end: Instant) -> Result<Value> {
        let left = end.saturating_duration_since(Instant::now());
        let Ok(message) = self.messages.recv_timeout(left) else {
            bail!(
                "the browser does not answer within {} s",
                PATIENCE.as_secs()
            );
        };
        let what = &message["params"];
        match message["method"].as_str() {
            Some("Page.loadEventFired") => self.loaded = true,
            Some("Runtime.exceptionThrown") => {
                let details = &what["exceptionDetails"];
                self.said
                    .push(format!("{} {}", details["text"], details["exception"]));
            }
            Some("Runtime.consoleAPICalled") => self.said.push(what["args"].to_string()),
            // Software rendering is slow, and the driver says so.
            Some("Log.entryAdded")
                if !what["entry"]["text"]
                    .as_str()
                    .is_some_and(|t| t.contains("GL Driver Message")) =>
            {
                self.said.push(what["entry"]["text"].to_string());
            }
            _ => {}
        }
        Ok(message)
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
