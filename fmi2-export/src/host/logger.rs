//! Messages to the master: ready texts in declared categories.

use crate::host::phase::Status;
use std::cell::Cell;
use std::fmt::Display;

/// A log category of the model description.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Category {
    /// Changes of state.
    Events,
    /// Done, but look at it.
    Warning,
    /// A rejected value or request.
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

    /// Those that are always sent: otherwise the reason of a failed call would be unknown.
    const ALWAYS: Mask = Mask(Category::Error.bit() | Category::Fatal.bit());

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
            Category::Events => "Changes of state of the controller; off at first, unless logging is switched on",
            Category::Warning => "The call succeeded with a warning; on by default",
            Category::Discard => "A value or request was rejected and nothing changed; on by default",
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

    const fn bit(self) -> u8 {
        1 << self as u8
    }
}

/// A set of categories.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Mask(u8);

impl Mask {
    /// The categories of a list, all of them for an empty one; and the first name that is none.
    fn of<'a>(names: &[&'a str]) -> (Self, Option<&'a str>) {
        let all = Category::ALL.iter().fold(0, |mask, category| mask | category.bit());
        let bits = |name: &str| match Category::ALL.iter().find(|category| category.name() == name) {
            Some(category) => category.bit(),
            None if name == "logAll" => all,
            None => 0,
        };
        let mask = names.iter().fold(if names.is_empty() { all } else { 0 }, |mask, name| mask | bits(name));
        (Self(mask), names.iter().copied().find(|name| bits(name) == 0))
    }
}

/// Receiver of messages: status, category, text.
pub type Callback = Box<dyn Fn(Status, Category, &str) + Send>;

/// Where an instance sends its messages.
pub struct Logger {
    callback: Option<Callback>,
    initial: Mask,
    wanted: Mask,
    /// Whether there was a warning since [`take_warned`](Self::take_warned), sent or not.
    warned: Cell<bool>,
}

impl Logger {
    /// A logger that sends to `callback`, with or without events.
    pub fn new(callback: Option<Callback>, events: bool) -> Self {
        let (all, _) = Mask::of(&[]);
        let initial = if events { all } else { Mask(all.0 & !Category::Events.bit()) };
        Self { callback, initial, wanted: initial, warned: Cell::new(false) }
    }

    /// Switches categories as fmi2SetDebugLogging asks: on means these and no others, off means without these; no
    /// category means all of them. Errors are always sent. An unknown name is reported and ignored.
    pub fn configure(&mut self, on: bool, categories: &[&str]) {
        let (named, unknown) = Mask::of(categories);
        if let Some(unknown) = unknown {
            let names = Category::ALL.map(Category::name).join("`, `");
            let text =
                format_args!("fmi2SetDebugLogging: `{unknown}` is no log category of this FMU (they are `{names}`)");
            self.send(Category::Warning, text);
        }
        self.wanted = Mask(if on { named.0 } else { self.wanted.0 & !named.0 });
    }

    /// As it was made.
    pub fn reset(&mut self) {
        self.wanted = self.initial;
    }

    /// Whether there was a warning since the last question.
    #[inline]
    pub fn take_warned(&self) -> bool {
        self.warned.get() && self.warned.replace(false)
    }

    /// Sends one message; it is formatted only when its category is on.
    pub fn send(&self, category: Category, text: impl Display) {
        if category == Category::Warning {
            self.warned.set(true);
        }
        if (self.wanted.0 | Category::ALWAYS.0) & category.bit() == 0 {
            return;
        }
        if let Some(callback) = &self.callback {
            callback(category.status(), category, &text.to_string());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Mutex};

    /// Sends one message of each category; returns the first letters of the categories that reach the callback.
    fn sent(logger: &Logger, heard: &Arc<Mutex<String>>) -> String {
        Category::ALL.iter().for_each(|category| logger.send(*category, "x"));
        std::mem::take(&mut heard.lock().unwrap())
    }

    fn listening(events: bool) -> (Logger, Arc<Mutex<String>>) {
        let heard = Arc::<Mutex<String>>::default();
        let ear = heard.clone();
        let write = move |_, category: Category, _: &str| ear.lock().unwrap().push_str(&format!("{category:?}")[..1]);
        (Logger::new(Some(Box::new(write)), events), heard)
    }

    #[test]
    fn categories_are_switched_as_the_standard_says_and_errors_stay() {
        for (on, names, wanted) in [
            (true, &[][..], "EWDEF"),
            (false, &[], "EF"),
            (true, &["logEvents"], "EEF"),
            (true, &["logStatusWarning", "logStatusDiscard"], "WDEF"),
            (false, &["logStatusWarning"], "DEF"),
            (false, &["logStatusError"], "WDEF"),
            (true, &["logAll"], "EWDEF"),
        ] {
            let (mut logger, heard) = listening(false);
            assert_eq!(sent(&logger, &heard), "WDEF");
            logger.configure(on, names);
            assert_eq!(sent(&logger, &heard), wanted, "{on} {names:?}");
            logger.reset();
            assert_eq!(sent(&logger, &heard), "WDEF");
        }
        let (mut logger, heard) = listening(true);
        logger.configure(false, &[]);
        logger.reset();
        assert_eq!(sent(&logger, &heard), "EWDEF");
    }

    #[test]
    fn an_unknown_category_is_reported_and_the_others_are_set() {
        let (mut logger, heard) = listening(true);
        logger.configure(true, &["nonsense", "logStatusDiscard"]);
        assert!(logger.take_warned());
        assert_eq!(sent(&logger, &heard), "WDEF");
        assert_eq!(sent(&logger, &heard), "DEF");
    }
}
