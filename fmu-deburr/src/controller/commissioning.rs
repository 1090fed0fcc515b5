//! The state `Commission`: what begins, moves and ends it, and what its results change.

use control_blocks::{ParameterError, export_commission, ticks};

use crate::commission::plan;
use crate::controller::Controller;
use crate::interface::{BankStatus, Fault, Parameters, State};
use crate::machine::Progress;
use crate::monitoring::finding::Finding;
use crate::monitoring::watch::Watch;
use crate::path::route::Route;
use crate::reading::Reading;

impl Controller {
    /// Puts what a commissioning run has measured into the parameters, where `commission.apply` says so; before each sample.
    pub fn bring_into_force(&mut self, p: &mut Parameters) {
        self.commissioning_run.put(p);
        if self.state == State::Commission && self.commissioning_run.finished {
            self.progress = Progress::Over;
        }
    }

    /// Writes the derived parameters of the last successful run to the file `commission.export`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn export(&self, p: &Parameters) -> Result<(), ParameterError> {
        export_commission(&p.commission.export, &self.commissioning_run.derived(p))
    }

    /// Starts; where the tool may be in the part, with a retract.
    pub(super) fn begin_commission(&mut self, p: &Parameters) {
        let start = if self.inside { p.arm.retracted(&self.joints, p.transfer.clearance) } else { self.joints };
        self.route = if self.inside { Route::out(p, &self.joints) } else { Route::at(&self.joints) };
        (self.on_path, self.commissioning) = (false, true);
        self.elapsed.restart();
        self.budget = u64::from(ticks(plan::time(p, self.path.speed), p.sample_period));
        self.commissioning_run.begin(p, self.path.speed, &start);
    }

    /// Moves the reference on: out of the part, then axis by axis.
    pub(super) fn follow_commission(&mut self, p: &Parameters) {
        if !self.route.over() {
            self.follow_route(p, false);
            (self.inside, self.progress) = (true, Progress::Busy);
            return;
        }
        self.inside = false;
        self.commissioning_run.experiment.advance(&mut self.joints, p.sample_period);
        self.finish_if(self.commissioning_run.finished);
    }

    /// Takes what this sample has read.
    pub(super) fn observe_commission(&mut self, p: &Parameters, reading: &Reading) {
        if self.state == State::Commission && !self.inside && !self.commissioning_run.finished {
            self.commissioning_run.observe(p, &self.error, reading.spindle_speed);
        }
    }

    /// Other values are in force, at rest: models and patterns are those of the drives as configured now.
    pub(super) fn renew(&mut self, p: &Parameters) {
        self.watch = Watch::new(p);
        self.watch.restart(p, &self.reader.positions());
        self.learner.configure(p);
        self.feedforward.configure(p);
        self.commissioning_run.report_std(&mut self.feedforward.drives);
        self.bank.set_delay(p.io_delay);
        (self.changed, self.learned, self.origin) = (false, false, BankStatus::Empty);
        if self.commissioning_run.applied() || p.bank.compute {
            self.compute(p);
        } else {
            // those that the commissioning run has computed go with it
            self.bank.limit(0);
        }
    }

    fn compute(&mut self, p: &Parameters) {
        let Self { feedforward, bank, path, start, .. } = self;
        bank.fill(|pattern| feedforward.fill(p, path, start, pattern));
        self.origin = BankStatus::Computed;
        if self.bank.largest() > p.limits.pulses_max {
            self.bank.limit(0);
            (self.origin, self.ended) = (BankStatus::Empty, Finding::plain(Fault::PatternTooLarge));
        }
    }
}
