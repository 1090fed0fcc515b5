//! Messages to the master: ready texts in declared categories.

use crate::phase::Status;
use std::fmt::Display;

/// A log category of the model description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Category {
    /// Changes of state worth telling; only when switched on.
    Events,
    /// Done, but look at it.
    Warning,
    /// A refused value or request.
    Discard,
    /// An error.
    Error,
    /// The instance is lost.
    Fatal,
}

impl Category {
    /// All categories in the order of the model description.
    pub const ALL: [Category; 5] =
        [Category::Events, Category::Warning, Category::Discard, Category::Error, Category::Fatal];

    /// Name as FMI 2.0 suggests it.
    pub const fn name(self) -> &'static str {
        match self {
            Category::Events => "logEvents",
            Category::Warning => "logStatusWarning",
            Category::Discard => "logStatusDiscard",
            Category::Error => "logStatusError",
            Category::Fatal => "logStatusFatal",
        }
    }

    /// One line for the model description.
    pub const fn description(self) -> &'static str {
        match self {
            Category::Events => "Changes of state of the controller; sent only when switched on",
            Category::Warning => "Something was done that deserves a look; always sent",
            Category::Discard => "A value or request was refused and nothing changed; always sent",
            Category::Error => "A call failed; always sent",
            Category::Fatal => "The instance is lost; always sent",
        }
    }

    const fn status(self) -> Status {
        match self {
            Category::Events => Status::Ok,
            Category::Warning => Status::Warning,
            Category::Discard => Status::Discard,
            Category::Error => Status::Error,
            Category::Fatal => Status::Fatal,
        }
    }
}

/// Receiver of messages: status, category, text.
pub type Callback = Box<dyn Fn(Status, Category, &str) + Send>;

/// Where an instance sends its messages.
pub struct Logger {
    callback: Option<Callback>,
    events: bool,
}

impl Logger {
    /// A logger that sends to `callback`, with or without events.
    pub fn new(callback: Option<Callback>, events: bool) -> Self {
        Self { callback, events }
    }

    /// Switches events as fmi2SetDebugLogging asks; no category means all of them.
    ///
    /// # Errors
    /// The first category that is not declared; nothing changes then.
    pub fn configure(&mut self, on: bool, categories: &[&str]) -> Result<(), String> {
        let declared = |name: &str| name == "logAll" || Category::ALL.iter().any(|c| c.name() == name);
        if let Some(unknown) = categories.iter().find(|name| !declared(name)) {
            let names = Category::ALL.map(Category::name).join("`, `");
            return Err(format!("`{unknown}` is no log category of this FMU (they are `{names}`)"));
        }
        let concerned = |name: &&str| *name == "logAll" || *name == Category::Events.name();
        if categories.is_empty() || categories.iter().any(concerned) {
            self.events = on;
        }
        Ok(())
    }

    /// Sends one message; nothing is formatted when nobody listens.
    pub fn send(&self, category: Category, text: impl Display) {
        if category == Category::Events && !self.events {
            return;
        }
        if let Some(callback) = &self.callback {
            callback(category.status(), category, &text.to_string());
        }
    }
}
