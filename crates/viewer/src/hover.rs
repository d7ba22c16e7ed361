//! Frames that can wait: a hand that hovers over the view is told what lies there once it rests, and nothing else of
//! the screen changes meanwhile.
//!
//! Each of its moves costs three frames otherwise, two of them for things to settle, and each turn of a wheel six,
//! since it is spread over some of them. Where frames are drawn by software, what the hand does next waits behind them.

use eframe::egui::Event;
use eframe::egui::MouseWheelUnit;
use eframe::egui::Pos2;
use std::time::Duration;
use web_time::Instant;

/// A hand that never rests has its frame after as long.
const MOST: Duration = Duration::from_secs(1);

/// Things settle once after as long, not with the next two frames.
const SETTLED: Duration = Duration::from_millis(200);

/// A wheel's turn by less than this, in points, is not spread over frames: such come from a touchpad.
const SMOOTH: f32 = 7.5;

/// What a hand has done since the last frame.
#[derive(Debug, Default)]
pub struct Hover {
    /// Since when frames have been put off.
    since: Option<Instant>,
    /// How many events they were to show.
    put_off: usize,
    /// When the last frame was, if nothing but a hand that hovers or turns the wheel has been shown lately.
    shown: Option<Instant>,
}

impl Hover {
    /// Whether the last frame showed nothing but a hand that hovers or turns the wheel: what it asked for settles when
    /// the hand rests.
    pub fn is_quiet(&self) -> bool {
        self.shown.is_some()
    }

    /// Whether the frame that shows these events can wait for more of them: those that have been put off, and then what
    /// has come since. Nothing waits where something else `is_wanted`, such as news.
    pub fn can_wait(
        &mut self,
        events: &[Event],
        is_over_view: impl Fn(Pos2) -> bool,
        is_wanted: bool,
        now: Instant,
    ) -> bool {
        let hovers = |event: &Event| {
            matches!(event, Event::MouseMoved(_))
                || matches!(event, Event::PointerMoved(at) if is_over_view(*at))
        };
        let is_quiet = |event: &Event| hovers(event) || matches!(event, Event::MouseWheel { .. });
        let within =
            |since: Option<Instant>, span| since.is_some_and(|since| now.duration_since(since) < span);
        let is_news = events.len() > self.put_off && events.iter().all(hovers);
        let is_early = self.since.is_none() || within(self.since, MOST);
        let can_wait = if events.is_empty() { within(self.shown, SETTLED) } else { is_news && is_early };
        if is_wanted || !can_wait {
            // What settles after a click is wanted at once.
            let is_quiet = events.iter().all(is_quiet) && !(events.is_empty() && self.shown.is_none());
            *self = Self { shown: is_quiet.then_some(now), ..Self::default() };
            return false;
        }
        if !events.is_empty() {
            self.since.get_or_insert(now);
            self.put_off = events.len();
        }
        true
    }
}

/// When a frame is due, by what the application asks for: an observer of its requests tells it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Due {
    at: Option<Instant>,
    /// Until when things settle that asked for a frame without delay: each such request is one for two.
    settles_until: Option<Instant>,
}

impl Due {
    /// A frame is asked for.
    pub fn ask(&mut self, delay: Duration, now: Instant) {
        if delay.is_zero() {
            self.settles_until = Some(now + SETTLED);
        } else {
            self.at = self.at.into_iter().chain(now.checked_add(delay)).min();
        }
    }

    /// A frame begins: whether it was asked for, or comes of events alone. What is due later stays.
    pub fn begin(&mut self, now: Instant) -> bool {
        let is_due = self.at.take_if(|at| *at <= now).is_some();
        is_due || self.settles_until.is_some_and(|until| now < until)
    }

    /// How long it is until the next one.
    pub fn wait(&self, now: Instant) -> Option<Duration> {
        self.at.map(|at| at.saturating_duration_since(now))
    }
}

/// The same events, with turns of a wheel (a line is so many points) in parts that are not spread over frames.
pub fn unspread(events: Vec<Event>, line: f32) -> Vec<Event> {
    let in_parts = |event| {
        let Event::MouseWheel { unit, delta, modifiers, phase, source } = event else { return vec![event] };
        let points = match unit {
            MouseWheelUnit::Point => delta,
            MouseWheelUnit::Line => delta * line,
            MouseWheelUnit::Page => return vec![event],
        };
        let parts = (points.length() / SMOOTH).ceil().clamp(1.0, 100.0);
        let (unit, delta) = (MouseWheelUnit::Point, points / parts);
        vec![Event::MouseWheel { unit, delta, modifiers, phase, source }; parts as usize]
    };
    events.into_iter().flat_map(in_parts).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui;
    use eframe::egui::pos2;
    use eframe::egui::vec2;

    const LATER: Duration = Duration::from_millis(100);

    fn over_view(at: Pos2) -> bool {
        at.x >= 10.0
    }

    fn turn(unit: MouseWheelUnit, y: f32) -> Event {
        let (modifiers, phase) = (egui::Modifiers::NONE, egui::TouchPhase::Move);
        Event::MouseWheel {
            unit,
            delta: vec2(0.0, y),
            modifiers,
            phase,
            source: egui::MouseWheelSource::Unknown,
        }
    }

    #[test]
    fn a_hand_that_hovers_has_its_frame_when_it_rests() {
        let (mut hover, start) = (Hover::default(), Instant::now());
        let mut events = vec![Event::PointerMoved(pos2(20.0, 0.0))];
        assert!(hover.can_wait(&events, over_view, false, start));
        events.push(Event::PointerMoved(pos2(21.0, 0.0)));
        assert!(hover.can_wait(&events, over_view, false, start));
        assert!(!hover.can_wait(&events, over_view, false, start), "it rests");
        assert!(hover.can_wait(&[], over_view, false, start), "what has to settle");
        assert!(!hover.can_wait(&[], over_view, false, start + SETTLED));
        assert!(hover.can_wait(&[], over_view, false, start + SETTLED * 3 / 2), "what settles after that");
        assert!(hover.can_wait(&events[..1], over_view, false, start), "it goes on");
    }

    #[test]
    fn a_hand_that_never_rests_has_frames_too() {
        let (mut hover, start) = (Hover::default(), Instant::now());
        let events: Vec<_> = (0..40).map(|x| Event::PointerMoved(pos2(20.0 + x as f32, 0.0))).collect();
        let shown = (1..40_u32).find(|&count| {
            let now = start + Duration::from_millis(50) * count;
            !hover.can_wait(&events[..count as usize], over_view, false, now)
        });
        assert_eq!(shown, Some(21), "a second after the first");
    }

    #[test]
    fn what_does_more_than_hover_has_its_frame_at_once() {
        let (mut hover, now) = (Hover::default(), Instant::now());
        let on_panel = Event::PointerMoved(pos2(5.0, 0.0));
        assert!(!hover.can_wait(&[on_panel], over_view, false, now));
        assert!(!hover.can_wait(&[], over_view, false, now), "what a panel has to settle");
        let events = [Event::PointerMoved(pos2(20.0, 0.0)), turn(MouseWheelUnit::Point, 3.0), Event::Copy];
        assert!(hover.can_wait(&events[..1], over_view, false, now));
        assert!(!hover.can_wait(&events[..2], over_view, false, now));
        assert!(hover.can_wait(&[], over_view, false, now), "a turn has nothing to settle");
        assert!(!hover.can_wait(&events, over_view, false, now));
        assert!(!hover.can_wait(&[], over_view, false, now));
    }

    #[test]
    fn news_never_waits() {
        let (mut hover, now) = (Hover::default(), Instant::now());
        let events = [Event::PointerMoved(pos2(20.0, 0.0))];
        assert!(!hover.can_wait(&events, over_view, true, now));
        assert!(!hover.can_wait(&[], over_view, true, now));
        assert!(hover.can_wait(&[], over_view, false, now));
        assert!(hover.can_wait(&events, over_view, false, now));
    }

    #[test]
    fn a_frame_that_is_due_later_is_not_asked_for_now() {
        let (mut due, start) = (Due::default(), Instant::now());
        let ms = |ms| start + Duration::from_millis(ms);
        assert!(!due.begin(start) && due.wait(start).is_none());
        due.ask(LATER, start);
        due.ask(LATER * 2, start);
        due.ask(Duration::MAX, start);
        assert!(!due.begin(ms(20)));
        assert_eq!(due.wait(ms(20)), Some(LATER - Duration::from_millis(20)));
        assert!(due.begin(start + LATER), "it stays due");
        assert!(!due.begin(start + LATER), "once");
        due.ask(Duration::ZERO, ms(500));
        assert!(due.begin(ms(500)) && due.begin(ms(510)), "things settle");
        assert!(!due.begin(ms(500) + SETTLED), "if there was a frame for them or not");
    }

    #[test]
    fn a_wheel_turns_within_one_frame() {
        for (unit, y) in [(MouseWheelUnit::Line, -3.0), (MouseWheelUnit::Point, -120.0)] {
            let ctx = egui::Context::default();
            let line = ctx.options(|options| options.input_options.line_scroll_speed);
            let turned = |events: Vec<Event>| {
                let mut turned = 0.0;
                let input = egui::RawInput { events, ..egui::RawInput::default() };
                let _ = ctx.run_ui(input, |ui| turned = ui.input(|input| input.smooth_scroll_delta.y));
                turned
            };
            let events = unspread(vec![turn(unit, y), Event::Copy], line);
            assert_eq!(events.last(), Some(&Event::Copy));
            let points = if unit == MouseWheelUnit::Line { y * line } else { y };
            assert!((turned(events) - points).abs() < 0.01);
            assert!(turned(vec![turn(unit, y)]) > points / 2.0, "without it, a part only");
        }
    }
}
