//! What `harness choose` says of the scene as it is now: asked of a process of its own, so that the window goes on.

use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::sync::{Arc, Mutex};

use eframe::egui;

use super::save;
use super::subject::Subject;
use crate::techniques::settings::{Settings, read};

/// What was chosen.
pub(super) struct Verdict {
    /// In words.
    pub text: String,
    /// The settings, where anything keeps the bound.
    pub settings: Option<Settings>,
}

/// A process that chooses.
pub(super) struct Choosing {
    result: Receiver<Result<Verdict, String>>,
    child: Arc<Mutex<Child>>,
}

impl Choosing {
    /// Begins to choose for an error of at most `percent`.
    pub(super) fn start(
        subject: &Subject,
        percent: f32,
        adapter: &str,
        window: egui::Context,
    ) -> Result<Self, String> {
        let folder = tempfile::tempdir().map_err(|error| format!("can't choose: {error}"))?;
        let scene = folder.path().join("scene.json");
        save::write_json(&scene, &save::scene(subject)?)?;
        let program = std::env::current_exe().map_err(|error| format!("can't choose: {error}"))?;
        let mut child = Command::new(program)
            .arg("choose")
            .arg("--scene")
            .arg(&scene)
            .args(["--max-error", &format!("{percent}%"), "--adapter", adapter])
            .arg("--output")
            .arg(folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| format!("can't choose: {error}"))?;
        let said = child.stderr.take();
        let child = Arc::new(Mutex::new(child));
        let (send, result) = channel();
        let waited = Arc::clone(&child);
        std::thread::spawn(move || {
            // The last line says what went wrong, if anything.
            let mut last = String::new();
            if let Some(said) = said {
                let lines = std::io::BufRead::lines(std::io::BufReader::new(said));
                lines.map_while(Result::ok).for_each(|line| last = line);
            }
            let ended = waited.lock().map(|mut child| child.wait());
            let ended = ended.is_ok_and(|status| status.is_ok());
            let verdict = if ended { outcome(folder.path(), &last) } else { Err(last) };
            // The window may be gone.
            drop(send.send(verdict));
            window.request_repaint();
        });
        Ok(Self { result, child })
    }

    /// What came out, once it is there.
    pub(super) fn poll(&self) -> Option<Result<Verdict, String>> {
        match self.result.try_recv() {
            Ok(result) => Some(result),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err("choosing ended without a word".into())),
        }
    }
}

impl Drop for Choosing {
    fn drop(&mut self) {
        // One that is waited for has closed its ears already.
        if let Ok(mut child) = self.child.try_lock() {
            drop(child.kill());
        }
    }
}

/// What the process has written, or the last that it said.
fn outcome(folder: &Path, last: &str) -> Result<Verdict, String> {
    let text = std::fs::read_to_string(folder.join("choice.md")).map_err(|_| last.to_owned())?;
    let settings = folder.join("choice.json");
    let settings = match settings.exists() {
        true => {
            let (method, model) = read(&settings).map_err(|failure| failure.to_string())?;
            Some(Settings::of(&method, &model))
        }
        false => None,
    };
    Ok(Verdict { text, settings })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_outcome_is_text_and_settings_or_the_last_words() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(outcome(folder.path(), "harness: no light").err().unwrap(), "harness: no light");
        std::fs::write(folder.path().join("choice.md"), "nothing").unwrap();
        assert!(outcome(folder.path(), "").unwrap().settings.is_none());
        std::fs::write(folder.path().join("choice.json"), r#"{"technique": "biri-ss"}"#).unwrap();
        let verdict = outcome(folder.path(), "").unwrap();
        assert_eq!(
            (verdict.text.as_str(), verdict.settings.unwrap().technique.as_str()),
            ("nothing", "biri-ss")
        );
    }
}
