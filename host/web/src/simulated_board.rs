//! Simulated board: takes the bytes of commands and gives the bytes of lines, as a board on USB does. A simulated person wears
//! its armband.
//!
//! ```text
//! commands -> CommandReader -> MyoSession, Pipeline, Installation -> lines
//!       DemoPerson -> SimulatedArmband --^
//! ```
//!
//! The work of the firmware's tasks is done in turn here, every 10 ms. Flash is memory, and power never fails.

use std::borrow::Cow;
use std::collections::VecDeque;
use std::fmt::{Display, Write as _};

use execution::revision::revision;
use recordings::labels::motion::Motion;
use shared::calibration::{Memory, RecordError, Shown, from_record};
use shared::hid;
use shared::installation::{
    BLOCK_BYTES, Block, Installation, InstallationProgress, InstallationStep, PAGE_BYTES, Refused,
};
use shared::intent::Intent;
use shared::model::encoder::{DeviceEncoder, DeviceState};
use shared::model::file::{Model, ModelError};
use shared::myo::{Action, Address, MyoEvent, MyoSession, Phase, Settings};
use shared::pipeline::{
    Absence, AlignmentPhase, Done, ModelInput, ModelRefused, Pipeline, Reports, Smoother,
};
use shared::stream::alignment::Arm;
use shared::stream::link_sequence::{Packet, QueueGapDetector, Sequencer};
use shared::stream::safe_state::Cause;
use shared::uart_line::Report;
use shared::uart_line::answer::{Answer, Binding, Counts, Identity, Refusal};
use shared::uart_line::calibration::{CalibrateCommand, CalibrationReport, CalibrationState};
use shared::uart_line::command::{AlignCommand, BindCommand, Command, CommandReader};
use shared::uart_line::emg::EmgReport;
use shared::uart_line::imu::ImuReport;
use shared::uf2::MODEL_REGION;
use shared::units::Millis;

use crate::flashed::flashed;
use crate::installer::{InstallError, ModelFile};
use crate::person::DemoPerson;
use crate::simulated_armband::SimulatedArmband;

/// Time of a step in ms: that of two samples.
pub const STEP_MS: u32 = 10;

/// Time in ms for which flash erases a page (nRF52840 product specification, NVMC).
const ERASE_MS: u32 = 85;

/// Name of the image, as of the firmware on a PC.
pub const IMAGE: &str = "simulated";

/// Content of flash.
struct Flash {
    /// Region of the model file, in words, which align it as a model requires; owned from its first change until it is in use.
    model: Cow<'static, [u32]>,
    /// Page with the record of the calibration; empty without one.
    calibration: &'static [u32],
    /// Armband that is bound.
    armband: Option<Address>,
}

/// Record of a calibration that is being written.
struct Keeping {
    /// Time at which its writing began.
    began: Millis,
    /// Model that it belongs to.
    model: u32,
    /// Memory with the learnt head; `None` to remove the record.
    learnt: Option<&'static mut Memory>,
}

/// Simulated board, with its wearer. What it borrows lasts as long as the program: its memory, and each model or calibration that
/// comes to flash.
pub struct SimulatedBoard {
    now: Millis,
    /// Wearer of the armband.
    pub person: DemoPerson,
    armband: SimulatedArmband,
    session: MyoSession,
    sequencer: Sequencer,
    detector: QueueGapDetector,
    streams: bool,
    pipeline: Pipeline<'static, DeviceEncoder<'static>>,
    /// CRC-32 of the model in use.
    model: Option<u32>,
    absence: Absence,
    flash: Flash,
    installation: Installation,
    calibration: CalibrationReport,
    in_use: Result<(), RecordError>,
    keeping: Option<Keeping>,
    reader: CommandReader,
    received: VecDeque<u8>,
    /// Command that waits until flash is free.
    waiting: Option<Result<Command, Refusal>>,
    lines: String,
    writes_raw: bool,
    writes_strength: bool,
    hid: hid::Settings,
}

impl SimulatedBoard {
    /// Starts a board with a model in flash, and the person's armband bound.
    ///
    /// # Errors
    /// When no board can run the model.
    pub fn start(file: &[u8], person: DemoPerson) -> Result<Self, InstallError> {
        let words = flashed(file, file.len());
        let file = ModelFile::new(&bytemuck::cast_slice(&words)[..file.len()])?;
        let checksum = file.checksum();
        let armband = Some(SimulatedArmband::ADDRESS);
        let state = Box::leak(Box::new(DeviceState::fresh()));
        let mut board = Self {
            now: Millis(0),
            person,
            armband: SimulatedArmband::default(),
            session: MyoSession::new(Settings {
                bound: armband,
                ..Settings::default()
            }),
            sequencer: Sequencer::default(),
            detector: QueueGapDetector::default(),
            streams: false,
            pipeline: Pipeline::without_model(state, Cause::Boot),
            model: None,
            absence: Absence::began(Millis(0), ModelRefused::Incomplete),
            flash: Flash {
                model: flashed(file.bytes(), MODEL_REGION.len()).into(),
                calibration: &[],
                armband,
            },
            installation: Installation::new(MODEL_REGION.end - MODEL_REGION.start),
            calibration: CalibrationReport::of(CalibrationState::Idle, None),
            in_use: Err(RecordError::Missing),
            keeping: None,
            reader: CommandReader::new(),
            received: VecDeque::new(),
            waiting: None,
            lines: String::new(),
            writes_raw: false,
            writes_strength: false,
            hid: hid::Settings::OFF,
        };
        board.pipeline.lend(Box::leak(Box::new(Memory::EMPTY)));
        let Identity {
            version, revision, ..
        } = board.identity();
        board.say(format_args!(
            "# myointent {version} {revision}, image {IMAGE}, model {checksum:08x}, started by power or reset\r\n"
        ));
        board.resume().map_err(|error| InstallError::Model {
            reason: error.to_string(),
        })?;
        let report = board.pipeline.state_report();
        board.say_report(report);
        Ok(board)
    }

    /// Takes bytes of commands.
    pub fn receive(&mut self, bytes: &[u8]) {
        self.received.extend(bytes);
    }

    /// Lets 10 ms pass, in which the wearer does what a session or a task on the page asks for, or what the board does. Returns the
    /// lines that are sent.
    pub fn step(&mut self, session: Option<Motion>, task: Option<Intent>) -> String {
        self.now = self.now.plus(STEP_MS);
        self.keep();
        self.wear(session, task);
        for event in self.armband.events() {
            self.radio(event.as_event());
        }
        self.radio(MyoEvent::Tick);
        let reports = self.pipeline.tick(self.now);
        self.report(reports);
        while let Some(command) = self.command() {
            let done = command.and_then(|command| self.carry_out(command));
            self.say(done.unwrap_or_else(Answer::Refused));
        }
        if !self.pipeline.has_model()
            && let Some(reason) = self.absence.due(self.now)
        {
            self.say(format_args!("# {reason}\r\n"));
            let report = self.pipeline.state_report();
            self.say_report(report);
        }
        if let Some(learnt) = self.pipeline.take_learnt() {
            self.give_up(Some(learnt));
        }
        std::mem::take(&mut self.lines)
    }

    /// Takes the next command. One that needs flash waits while a calibration is written, and those behind it with it.
    fn command(&mut self) -> Option<Result<Command, Refusal>> {
        let mut received = std::iter::from_fn(|| self.received.pop_front());
        let next = self.waiting.take();
        let next = next.or_else(|| received.find_map(|byte| self.reader.push(byte)))?;
        let needs_flash = matches!(next, Ok(Command::Install(_) | Command::Block(..)));
        if needs_flash && self.keeping.is_some() {
            self.waiting = Some(next);
            return None;
        }
        Some(next)
    }

    fn say(&mut self, line: impl Display) {
        // A `String` takes everything.
        let _ = write!(self.lines, "{line}");
    }

    fn say_report(&mut self, mut report: Report) {
        report.strength = report.strength.filter(|_| self.writes_strength);
        self.say(report);
    }

    /// Writes what a call of the pipeline gave, and what is new about alignment and calibration.
    fn report(&mut self, reports: Reports) {
        for report in reports {
            self.say_report(report);
        }
        if let Some(report) = self.pipeline.take_alignment_report() {
            self.say(report);
        }
        if let Some(report) = self.pipeline.take_calibration_report() {
            self.calibrates(report);
        }
    }

    /// Has the wearer do what is asked for, and the armband send it.
    fn wear(&mut self, session: Option<Motion>, task: Option<Intent>) {
        use CalibrationState::{Judging, Teaching};
        if let Some(motion) = session {
            self.person.ask(motion);
        }
        let cue = match (self.calibration.state, self.calibration.cue) {
            (Teaching | Judging, Some(Shown::Intent(cue))) => Some(cue),
            _ => None,
        };
        self.person.calibrate(cue.or(task));
        let is_aligning = self.pipeline.alignment_phase() == AlignmentPhase::Waiting;
        if self.person.align(is_aligning) {
            // The wearer presses the button again, at rest.
            self.pipeline.begin_alignment(Arm::Unknown);
        }
        if self.armband.streams() {
            let (pair, _) = self.person.next(self.sequencer.due());
            self.armband.notify(pair);
        }
    }

    fn radio(&mut self, event: MyoEvent<'_>) {
        let mut actions = Vec::new();
        let act = &mut |action| actions.push(action);
        self.session.handle(self.now, event, act);
        for action in actions {
            match action {
                Action::Deliver(pair) => {
                    let packet = self.sequencer.samples(pair);
                    self.packet(packet);
                }
                Action::Gap { missing } => self.sequencer.gap(missing),
                Action::StreamEnded => {
                    let packet = self.sequencer.end();
                    self.packet(packet);
                }
                Action::Imu(imu) => {
                    let sample = self.sequencer.due();
                    self.say(ImuReport { sample, imu });
                }
                Action::Keep(armband) => self.flash.armband = armband,
                action => self.armband.act(action),
            }
        }
    }

    fn packet(&mut self, packet: Packet) {
        let (now, first) = (self.now, packet.first);
        let received = self.detector.receive(packet);
        if received.disconnected {
            let reports = self.pipeline.disconnected(now);
            self.report(reports);
        }
        if received.missing > 0 {
            let reports = self.pipeline.gap(now, received.missing);
            self.report(reports);
        }
        for sample in received.samples.into_iter().flatten() {
            let reports = self.pipeline.sample(now, sample);
            self.report(reports);
        }
        self.streams = received.samples.is_some();
        if let Some(samples) = received.samples.filter(|_| self.writes_raw) {
            self.say(EmgReport { first, samples });
        }
    }

    fn carry_out(&mut self, command: Command) -> Result<Answer<'static>, Refusal> {
        Ok(match command {
            Command::Identify => Answer::Identity(self.identity()),
            Command::Battery => Answer::Battery(None),
            Command::Counters => Answer::Counts(Counts {
                session: self.session.counters(),
                ..Counts::default()
            }),
            Command::Raw(on) => {
                self.writes_raw = on;
                Answer::Raw(on)
            }
            Command::Imu(on) => {
                self.session.set_imu(on);
                Answer::Imu(on)
            }
            Command::Strength(on) => {
                self.writes_strength = on;
                Answer::Strength(on)
            }
            Command::Hid(command) => {
                self.hid = self.hid.after(command);
                Answer::Hid(self.hid)
            }
            Command::Calibrate(CalibrateCommand::State) => self.calibration(),
            Command::Align(AlignCommand::State) => Answer::Alignment(self.pipeline.alignment()),
            Command::Align(_) | Command::Bind(_) | Command::Gate(_) | Command::Calibrate(_)
                if self.model.is_none() =>
            {
                return Err(Refusal::NoModel);
            }
            Command::Bind(command) => self.bind(command)?,
            Command::Align(command) => {
                let done = self.pipeline.align(command, self.streams, Arm::Unknown)?;
                self.report(Reports::default());
                self.answer(done)
            }
            Command::Gate(command) => {
                let done = self.pipeline.change_gate(command)?;
                self.answer(done)
            }
            Command::Lock(command) => {
                let done = self.pipeline.change_lock(command);
                self.answer(done)
            }
            Command::Calibrate(command) => {
                let (now, arm) = (self.now, Arm::Unknown);
                let reports = self.pipeline.calibrate(now, command, self.streams, arm)?;
                self.report(reports);
                if command == CalibrateCommand::Forget {
                    self.give_up(None);
                }
                self.answer(Done::Calibrated)
            }
            Command::Install(transfer) if self.model == Some(transfer.checksum) => {
                Answer::Install(InstallationProgress::Installed)
            }
            Command::Install(transfer) => Answer::Install(self.installation.begin(transfer, None)?),
            Command::Block(number, block) => Answer::Install(self.take(number, &block)?),
        })
    }

    fn identity(&self) -> Identity<'static> {
        let is_connected = matches!(self.session.phase(), Phase::SettingUp | Phase::Streaming);
        let connected = is_connected.then_some(&self.session);
        Identity {
            version: env!("CARGO_PKG_VERSION"),
            revision: revision().unwrap_or("unknown"),
            image: IMAGE,
            model: self.model,
            armband: connected.and_then(MyoSession::armband),
            firmware: connected.and_then(MyoSession::firmware),
            battery: connected.and_then(MyoSession::battery),
        }
    }

    fn bind(&mut self, command: BindCommand) -> Result<Answer<'static>, Refusal> {
        if let Some(event) = command.event(self.session.following(), self.flash.armband)? {
            self.radio(event);
        }
        Ok(Answer::Binding(Binding {
            following: self.session.following(),
            is_kept: self.session.bound() == self.flash.armband,
        }))
    }

    /// Answer to a command to the pipeline.
    fn answer(&self, done: Done) -> Answer<'static> {
        done.answer(|| self.calibration())
    }

    fn calibration(&self) -> Answer<'static> {
        Answer::Calibration(self.calibration, self.in_use.is_ok())
    }

    /// Notes how far a calibration is, and says it.
    fn calibrates(&mut self, report: CalibrationReport) {
        self.calibration = report;
        self.say(report);
    }

    /// Gives up the model while its calibration is written, or removed.
    fn give_up(&mut self, learnt: Option<&'static mut Memory>) {
        let Some(model) = self.model else {
            return;
        };
        self.suspend(ModelRefused::Keeping);
        if learnt.is_none() {
            self.calibrates(CalibrationReport::of(CalibrationState::Keeping, None));
        }
        self.keeping = Some(Keeping {
            began: self.now,
            model,
            learnt,
        });
    }

    /// Puts the model in use again once its calibration is written.
    fn keep(&mut self) {
        let now = self.now;
        let is_over = |keeping: &mut Keeping| now.elapsed_since(keeping.began) >= ERASE_MS;
        let Some(Keeping { model, learnt, .. }) = self.keeping.take_if(is_over) else {
            return;
        };
        let wanted = learnt.is_some();
        self.flash.calibration = &[];
        if let Some(memory) = learnt {
            self.flash.calibration = flashed(memory.record(model), PAGE_BYTES).leak();
            self.pipeline.lend(memory);
        }
        if let Err(error) = self.resume() {
            self.refuse(error);
        }
        let state = match (wanted, self.in_use.is_ok()) {
            (true, true) => CalibrationState::Done,
            (false, false) => CalibrationState::Idle,
            _ => CalibrationState::NotKept,
        };
        self.calibrates(CalibrationReport {
            state,
            ..self.calibration
        });
    }

    fn suspend(&mut self, reason: ModelRefused) {
        self.model = None;
        let reports = self.pipeline.suspend(self.now);
        self.report(reports);
        self.absence = Absence::began(self.now, reason);
    }

    /// Puts the model in flash in use, with its calibration.
    fn resume(&mut self) -> Result<(), ModelRefused> {
        let region: &'static [u32] = match std::mem::take(&mut self.flash.model) {
            Cow::Borrowed(region) => region,
            Cow::Owned(region) => region.leak(),
        };
        self.flash.model = Cow::Borrowed(region);
        let (model, mut encoder, smoother) = parts(region)?;
        let kept = from_record(bytemuck::cast_slice(self.flash.calibration), &model);
        if let Ok(head) = kept {
            encoder.set_head(head);
        }
        let input = ModelInput {
            preprocessing: model.header.preprocessing,
            template: model.header.template,
            alignment: kept.map(|head| head.alignment).unwrap_or_default(),
        };
        self.pipeline.resume(self.now, encoder, smoother, input);
        self.model = Some(model.checksum);
        self.in_use = kept.map(|_| ());
        match self.in_use {
            Ok(()) | Err(RecordError::Missing) => {}
            Err(error) => self.say(format_args!("# {error}\r\n")),
        }
        self.report(Reports::default());
        Ok(())
    }

    /// Says that flash holds no model that can be run, and why.
    fn refuse(&mut self, error: ModelRefused) -> Refused {
        self.say(format_args!("# {error}\r\n"));
        let reports = self.pipeline.refuse_model(self.now);
        self.report(reports);
        self.absence = Absence::began(self.now, error);
        Refused::Model
    }

    /// Takes a block of a model file.
    fn take(&mut self, number: u32, block: &Block) -> Result<InstallationProgress, Refused> {
        let mut refused = None;
        let is_ours = |first: &Block| match Model::parse(&first.0) {
            // All that a block can say.
            Err(ModelError::Length { .. }) => true,
            Ok(_) => false,
            Err(error) => {
                refused = Some(ModelRefused::from(error));
                false
            }
        };
        let taken = self.installation.take(number, block, is_ours);
        if let Some(error) = refused {
            self.say(format_args!("# {error}\r\n"));
        }
        taken?;
        while let Some(step) = self.installation.step() {
            let outcome = self.install(step).map_err(|error| self.refuse(error));
            self.installation.done(outcome)?;
        }
        Ok(self.installation.progress())
    }

    fn install(&mut self, step: InstallationStep) -> Result<(), ModelRefused> {
        match step {
            InstallationStep::Suspend => self.suspend(ModelRefused::Incomplete),
            InstallationStep::ErasePage(page) => {
                self.region(page as usize * PAGE_BYTES, PAGE_BYTES)
                    .fill(0xff);
            }
            InstallationStep::WriteBlock(number) => {
                let content = self.installation.content().0;
                self.region(number as usize * BLOCK_BYTES, BLOCK_BYTES)
                    .copy_from_slice(&content);
            }
            InstallationStep::Verify => {
                parts(&self.flash.model)?;
            }
            InstallationStep::Resume => self.resume()?,
            // Power never fails.
            InstallationStep::EraseJournal
            | InstallationStep::WriteJournal
            | InstallationStep::MarkPage(_)
            | InstallationStep::EndJournal => {}
        }
        Ok(())
    }

    /// Part of the model's region that is written.
    fn region(&mut self, from: usize, length: usize) -> &mut [u8] {
        &mut bytemuck::cast_slice_mut(self.flash.model.to_mut())[from..][..length]
    }
}

/// Reads a model as a board does.
fn parts(region: &[u32]) -> Result<(Model<'_>, DeviceEncoder<'_>, Smoother), ModelRefused> {
    let model = Model::parse(bytemuck::cast_slice(region))?;
    let encoder = DeviceEncoder::new(&model)?;
    let smoother = Smoother::new(model.header.smoother.in_patches(), encoder.classes())?;
    Ok((model, encoder, smoother))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::demo;
    use crate::person::Cues;
    use shared::installation::Transfer;
    use shared::uart_line::line::{Line, LineReader};

    fn board() -> SimulatedBoard {
        let person = DemoPerson::new(demo::follower(), Cues::List(demo::cues()));
        SimulatedBoard::start(crate::SHIPPED, person).unwrap()
    }

    /// Answer to a line, and the comments beside it.
    fn said(board: &mut SimulatedBoard, line: &str) -> (Option<Answer<'static>>, String) {
        board.receive(line.as_bytes());
        let lines = board.step(None, None);
        let (mut reader, mut answer, mut comments) = (LineReader::default(), None, String::new());
        for byte in lines.bytes() {
            match reader.push(byte).transpose().unwrap() {
                Some(Line::Answer(Answer::Refused(why))) => answer = Some(Answer::Refused(why)),
                Some(Line::Answer(Answer::Install(next))) => answer = Some(Answer::Install(next)),
                Some(Line::Answer(Answer::Hid(outputs))) => answer = Some(Answer::Hid(outputs)),
                Some(Line::Answer(Answer::Imu(on))) => answer = Some(Answer::Imu(on)),
                Some(Line::Comment(text)) => comments += text,
                _ => {}
            }
        }
        (answer, comments)
    }

    #[test]
    fn it_refuses_what_a_board_refuses() {
        let mut board = board();
        let (_, first) = said(&mut board, "");
        assert!(first.contains(", image simulated, model "), "{first}");
        let file = crate::SHIPPED;
        let own = ModelFile::new(file).unwrap();
        let transfer = |length, checksum| Command::Install(Transfer { length, checksum });
        let begin = CalibrateCommand::Begin { others: false };
        let block = |file: &[u8]| Command::Block(0, Block::of(file, 0)).to_string();
        let refused = |why| Some(Answer::Refused(why));
        for (line, answer) in [
            (
                Command::Align(AlignCommand::Begin(Arm::Unknown)).to_string(),
                refused(Refusal::NoStream),
            ),
            (
                Command::Calibrate(begin).to_string(),
                refused(Refusal::NoStream),
            ),
            ("$IDENTIFY*05\r\n".to_owned(), refused(Refusal::Checksum(4))),
            (block(file), refused(Refusal::NotBegun)),
            (transfer(1 << 20, 1).to_string(), refused(Refusal::Length)),
            (
                transfer(file.len() as u32, own.checksum()).to_string(),
                Some(Answer::Install(InstallationProgress::Installed)),
            ),
            (
                transfer(file.len() as u32, 1).to_string(),
                Some(Answer::Install(InstallationProgress::Next(0))),
            ),
        ] {
            assert_eq!(said(&mut board, &line).0, answer, "{line}");
        }
        let (answer, why) = said(&mut board, &block(&[0; 64]));
        assert_eq!(answer, refused(Refusal::Model));
        assert!(why.starts_with(" model refused: "), "{why}");
    }

    #[test]
    fn without_a_whole_model_it_does_nothing_with_one() {
        let mut board = board();
        let mut damaged = crate::SHIPPED.to_vec();
        let transfer = Transfer {
            length: damaged.len() as u32,
            checksum: 1,
        };
        // Where a calibration is kept, an installation waits, and nothing before it.
        let forget = Command::Calibrate(CalibrateCommand::Forget);
        let install = Command::Install(transfer);
        let (answer, _) = said(
            &mut board,
            &format!("{forget}{}{install}", Command::Imu(true)),
        );
        assert_eq!(answer, Some(Answer::Imu(true)));
        let waits = (0..).take_while(|_| said(&mut board, "").0.is_none());
        assert_eq!(waits.count(), 8);
        assert!(board.model.is_some());
        // The file's own checksum is another one than was told: it is refused once it is whole.
        damaged[1000] ^= 1;
        let mut next = 0;
        let end = loop {
            let line = Command::Block(next, Block::of(&damaged, next)).to_string();
            match said(&mut board, &line) {
                (Some(Answer::Install(InstallationProgress::Next(number))), _) => next = number,
                end => break end,
            }
            assert_eq!(board.model, None);
            let bind = Command::Bind(BindCommand::State).to_string();
            assert_eq!(
                said(&mut board, &bind).0,
                Some(Answer::Refused(Refusal::NoModel))
            );
        };
        assert_eq!(end.0, Some(Answer::Refused(Refusal::Model)));
        assert!(end.1.starts_with(" model refused: "), "{}", end.1);
        assert!(board.pipeline.status().cause().is_some());
        // It says so again each second.
        let again: String = (0..100).map(|_| said(&mut board, "").1).collect();
        assert_eq!(again, end.1);
    }
}
