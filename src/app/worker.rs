//! The thread that opens files and calibrates, so that no frame ever waits.
//!
//! The newest request wins: requests that pile up behind a running one are answered by one run with the last
//! settings. Each reply carries the number of its request, so a stale one is recognised.

use std::panic::AssertUnwindSafe;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use eframe::egui;

use super::plots::PreparedPlots;
use crate::analysis::{Analysis, Analyst, Settings};
use crate::deployment::{Deployment, Sample, open};

/// Where a deployment comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    Path(PathBuf),
    Sample(Sample),
}

enum Request {
    Open(u64, Source),
    Analyse(u64, Arc<Deployment>, Settings),
}

pub enum Reply {
    Opened(u64, Result<Arc<Deployment>, String>),
    Analysed(u64, Arc<Analysis>, Arc<PreparedPlots>),
    /// A request ended in a bug of the program.
    Failed(u64),
    /// The user chose a path in a dialog.
    Picked(PathBuf),
    /// Something that ran beside the worker is done: a line for the user, or why it failed.
    Done(Result<String, String>),
}

/// The window's end of the thread.
pub struct Worker {
    requests: Sender<Request>,
    replies: Receiver<Reply>,
    reply_to: Sender<Reply>,
    ctx: egui::Context,
    newest: u64,
}

impl Worker {
    pub fn start(ctx: egui::Context) -> Self {
        let (requests, inbox) = channel();
        let (outbox, replies) = channel();
        let reply_to = outbox.clone();
        let repaint = ctx.clone();
        // Ends when the window drops its sender.
        std::thread::Builder::new()
            .name("resect worker".to_owned())
            .spawn(move || work(&inbox, &outbox, &repaint))
            .expect("a thread can be started");
        Self { requests, replies, reply_to, ctx, newest: 0 }
    }

    /// Asks for a deployment; gives the request's number.
    pub fn open(&mut self, source: Source) -> u64 {
        self.send(|number| Request::Open(number, source))
    }

    /// Asks for an analysis; gives the request's number.
    pub fn analyse(&mut self, deployment: Arc<Deployment>, settings: Settings) -> u64 {
        self.send(|number| Request::Analyse(number, deployment, settings))
    }

    fn send(&mut self, request: impl FnOnce(u64) -> Request) -> u64 {
        self.newest += 1;
        // The worker lives as long as this end of the channel: it catches its own panics.
        self.requests.send(request(self.newest)).ok();
        self.newest
    }

    /// Runs something beside the worker (a dialog, an export) and repaints when it is done.
    pub fn beside(&self, job: impl FnOnce() -> Option<Reply> + Send + 'static) {
        let (outbox, ctx) = (self.reply_to.clone(), self.ctx.clone());
        std::thread::spawn(move || {
            if let Some(reply) = job() {
                outbox.send(reply).ok();
                ctx.request_repaint();
            }
        });
    }

    pub fn try_reply(&self) -> Option<Reply> {
        self.replies.try_recv().ok()
    }

    /// Waits for the next reply; for pictures and tests.
    pub fn wait_reply(&self) -> Option<Reply> {
        self.replies.recv_timeout(std::time::Duration::from_secs(120)).ok()
    }
}

fn work(inbox: &Receiver<Request>, outbox: &Sender<Reply>, ctx: &egui::Context) {
    let mut analyst: Option<Analyst> = None;
    while let Ok(first) = inbox.recv() {
        let mut waiting = vec![first];
        waiting.extend(inbox.try_iter());
        for request in &without_overtaken(waiting) {
            let number = match request {
                Request::Open(number, _) | Request::Analyse(number, ..) => *number,
            };
            let answer =
                std::panic::catch_unwind(AssertUnwindSafe(|| reply(request, &mut analyst)));
            let reply = answer.unwrap_or_else(|_| {
                analyst = None;
                Reply::Failed(number)
            });
            if outbox.send(reply).is_err() {
                return;
            }
            ctx.request_repaint();
        }
    }
}

/// What is still worth doing: of several analyses only the last, of everything else all.
fn without_overtaken(waiting: Vec<Request>) -> Vec<Request> {
    let newest = waiting.iter().rposition(|request| matches!(request, Request::Analyse(..)));
    waiting
        .into_iter()
        .enumerate()
        .filter(|(at, request)| !matches!(request, Request::Analyse(..)) || Some(*at) == newest)
        .map(|(_, request)| request)
        .collect()
}

fn reply(request: &Request, analyst: &mut Option<Analyst>) -> Reply {
    match request {
        Request::Open(number, source) => {
            let opened = match source {
                Source::Path(path) => open(path),
                Source::Sample(sample) => sample.open(),
            };
            Reply::Opened(*number, opened.map(Arc::new).map_err(|error| error.to_string()))
        }
        Request::Analyse(number, deployment, settings) => {
            let known = analyst.take().filter(|a| Arc::ptr_eq(a.deployment(), deployment));
            let analyst =
                analyst.insert(known.unwrap_or_else(|| Analyst::new(Arc::clone(deployment))));
            let analysis = analyst.run(settings);
            let plots = PreparedPlots::of(&analysis, deployment.start_s().unwrap_or(0.0));
            Reply::Analysed(*number, Arc::new(analysis), Arc::new(plots))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_several_analyses_only_the_newest_is_run() {
        let deployment = Arc::new(Sample::Warthog.open().expect("built in"));
        let analyse =
            |number| Request::Analyse(number, Arc::clone(&deployment), Settings::default());
        let open = |number| Request::Open(number, Source::Sample(Sample::Hd2Tunnel));
        let left = without_overtaken(vec![analyse(1), open(2), analyse(3), analyse(4)]);
        let numbers: Vec<u64> = left
            .iter()
            .map(|request| match request {
                Request::Open(number, _) | Request::Analyse(number, ..) => *number,
            })
            .collect();
        assert_eq!(numbers, [2, 4]);
    }
}
