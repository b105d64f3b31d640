//! The thread that opens files and calibrates, so that no frame ever waits.
//!
//! The newest request wins: requests that pile up behind a running one are answered by one run with the last
//! settings. Each reply carries the number of its request, so a stale one is recognised.

use std::collections::HashMap;
use std::panic::AssertUnwindSafe;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

use eframe::egui;

use super::plots::PreparedPlots;
use super::scene::{CloudMaker, Clouds};
use super::studies::StudyResult;
use crate::analysis::{Analysis, Analyst, Settings};
use crate::deployment::{Deployment, Sample, open};
use crate::experiment::StudyError;

/// Where a deployment comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    Path(PathBuf),
    Sample(Sample),
}

enum Request {
    Open(u64, Source),
    Analyse {
        number: u64,
        id: u64,
        deployment: Arc<Deployment>,
        settings: Settings,
    },
    /// The deployment with this id was closed.
    Forget(u64),
}

impl Request {
    fn number(&self) -> u64 {
        match self {
            Self::Open(number, _) | Self::Analyse { number, .. } | Self::Forget(number) => *number,
        }
    }
}

pub enum Reply {
    Opened(u64, Result<Arc<Deployment>, String>),
    Analysed {
        number: u64,
        id: u64,
        analysis: Arc<Analysis>,
        plots: Arc<PreparedPlots>,
        clouds: Clouds,
    },
    Studied(u64, Result<Arc<StudyResult>, StudyError>),
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
    pub fn analyse(&mut self, id: u64, deployment: Arc<Deployment>, settings: Settings) -> u64 {
        self.send(|number| Request::Analyse { number, id, deployment, settings })
    }

    /// Lets go of what is remembered of a deployment.
    pub fn forget(&mut self, id: u64) {
        self.requests.send(Request::Forget(id)).ok();
    }

    /// Runs a study beside the worker; gives the request's number.
    pub fn study(
        &mut self,
        run: impl FnOnce() -> Result<Arc<StudyResult>, StudyError> + Send + 'static,
    ) -> u64 {
        self.newest += 1;
        let number = self.newest;
        self.beside(move || {
            let result = std::panic::catch_unwind(AssertUnwindSafe(run));
            Some(result.map_or(Reply::Failed(number), |result| Reply::Studied(number, result)))
        });
        number
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

/// Of each deployment: who analyses it and who makes its clouds.
type Analysts = HashMap<u64, (Analyst, CloudMaker)>;

fn work(inbox: &Receiver<Request>, outbox: &Sender<Reply>, ctx: &egui::Context) {
    let mut analysts: Analysts = HashMap::new();
    while let Ok(first) = inbox.recv() {
        let mut waiting = vec![first];
        waiting.extend(inbox.try_iter());
        for request in without_overtaken(waiting) {
            let number = request.number();
            let answer =
                std::panic::catch_unwind(AssertUnwindSafe(|| reply(request, &mut analysts)));
            let reply = answer.unwrap_or_else(|_| {
                analysts.clear();
                Some(Reply::Failed(number))
            });
            if let Some(reply) = reply {
                if outbox.send(reply).is_err() {
                    return;
                }
                ctx.request_repaint();
            }
        }
    }
}

/// What is still worth doing: of several analyses of a deployment only the last, of everything else all.
fn without_overtaken(waiting: Vec<Request>) -> Vec<Request> {
    let analysed = |request: &Request| match request {
        Request::Analyse { id, .. } => Some(*id),
        _ => None,
    };
    let ids: Vec<Option<u64>> = waiting.iter().map(analysed).collect();
    waiting
        .into_iter()
        .enumerate()
        .filter(|(at, _)| ids[*at].is_none() || !ids[at + 1..].contains(&ids[*at]))
        .map(|(_, request)| request)
        .collect()
}

fn reply(request: Request, analysts: &mut Analysts) -> Option<Reply> {
    match request {
        Request::Open(number, source) => {
            let opened = match source {
                Source::Path(path) => open(&path),
                Source::Sample(sample) => sample.open(),
            };
            Some(Reply::Opened(number, opened.map(Arc::new).map_err(|error| error.to_string())))
        }
        Request::Analyse { number, id, deployment, settings } => {
            let start_s = deployment.start_s().unwrap_or(0.0);
            let (analyst, clouds) = analysts
                .entry(id)
                .or_insert_with(|| (Analyst::new(deployment), CloudMaker::default()));
            let analysis = analyst.run(&settings);
            let clouds = clouds.make(analyst.deployment(), &analysis);
            let plots = PreparedPlots::of(&analysis, start_s);
            Some(Reply::Analysed {
                number,
                id,
                analysis: Arc::new(analysis),
                plots: Arc::new(plots),
                clouds,
            })
        }
        Request::Forget(id) => {
            analysts.remove(&id);
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_several_analyses_of_a_deployment_only_the_newest_is_run() {
        let deployment = Arc::new(Sample::Warthog.open().expect("built in"));
        let analyse = |number, id| Request::Analyse {
            number,
            id,
            deployment: Arc::clone(&deployment),
            settings: Settings::default(),
        };
        let open = |number| Request::Open(number, Source::Sample(Sample::Hd2Tunnel));
        let waiting = vec![analyse(1, 7), open(2), analyse(3, 7), analyse(4, 8), analyse(5, 7)];
        let left: Vec<u64> = without_overtaken(waiting).iter().map(Request::number).collect();
        assert_eq!(left, [2, 4, 5]);
    }
}
