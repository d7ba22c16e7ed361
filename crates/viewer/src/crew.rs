//! Several tracers of one picture: one leads, puts the picture together and deals tiles out to its mates, as many at a
//! time as they have some milliseconds of work with. Nobody waits for a mate: what it does not trace the leader does.

use crate::bundle::Bundle;
use crate::clerk::Clerk;
use crate::wire::Ask;
use crate::wire::Tell;
use std::ops::Range;
use std::time::Duration;
use web_time::Instant;

/// What a mate has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scene {
    /// None that could be traced.
    None,
    /// The leader's, soon.
    Coming,
    /// The leader's.
    There,
}

#[derive(Debug)]
struct Mate {
    scene: Scene,
    /// When each share that it has not ended was sent.
    open: Vec<Instant>,
    /// How many tiles its next share has.
    size: usize,
}

/// What goes to the screen, and what to which mate.
#[derive(Debug, Default)]
pub struct Post {
    /// For the screen.
    pub tells: Vec<Tell>,
    /// For mates by their numbers.
    pub asks: Vec<(usize, Ask)>,
}

/// See the module.
#[derive(Debug)]
pub struct Crew {
    mates: Vec<Mate>,
    /// How many mates there is room for, once the leader has a scene.
    room: fn() -> usize,
    /// The scene, and the picture.
    number: u64,
    serial: u64,
}

/// A mate has so many shares at most: one that it traces, and one for when it has done so.
const SHARES: usize = 2;

/// Tiles of a share.
const SIZES: Range<usize> = 1..64;

/// How long a share should take from being sent to its end.
const TIME: Range<Duration> = Duration::from_millis(40)..Duration::from_millis(120);

impl Crew {
    /// So many mates, as far as there is room.
    pub fn new(mates: usize, room: fn() -> usize) -> Self {
        let mate = |_| Mate { scene: Scene::None, open: Vec::new(), size: SIZES.start };
        Self { mates: (0..mates).map(mate).collect(), room, number: 0, serial: 0 }
    }

    /// Takes what the screen asks of the leader.
    pub fn take(&mut self, ask: Ask, leader: &mut Clerk) -> Post {
        let mut asks = Vec::new();
        let opens = match &ask {
            Ask::Open { number, .. } => {
                self.number = *number;
                self.mates.iter_mut().for_each(|mate| mate.scene = Scene::None);
                self.drop_shares(&mut asks);
                (!self.mates.is_empty()).then(|| ask.clone())
            }
            Ask::Style(_) | Ask::Hide(_) => {
                self.drop_shares(&mut asks);
                let mates = self.mates.iter().enumerate().filter(|(_, mate)| mate.scene != Scene::None);
                asks.extend(mates.map(|(number, _)| (number, ask.clone())));
                None
            }
            Ask::Draw(request) => {
                self.serial = request.serial;
                self.drop_shares(&mut asks);
                None
            }
            Ask::Stop => {
                self.drop_shares(&mut asks);
                None
            }
            Ask::Hold | Ask::GoOn => {
                asks.extend((0..self.mates.len()).map(|number| (number, ask.clone())));
                None
            }
            Ask::Look(..) | Ask::Inspect(..) | Ask::Shown | Ask::Store(..) | Ask::Help(_) => None,
        };
        let tells = leader.handle(ask, &Bundle::default());
        if let Some(open) = opens.filter(|_| matches!(tells.as_slice(), [Tell::Prepared(..)])) {
            for (number, mate) in self.mates.iter_mut().enumerate().take((self.room)()) {
                mate.scene = Scene::Coming;
                asks.push((number, open.clone()));
            }
        }
        self.deal(leader, &mut asks);
        Post { tells, asks }
    }

    /// Takes what a mate tells.
    pub fn heard(&mut self, number: usize, tell: Tell, leader: &mut Clerk) -> Post {
        let mut post = Post::default();
        let Some(mate) = self.mates.get_mut(number) else { return post };
        match tell {
            Tell::Prepared(scene, _) if scene == self.number => {
                mate.scene = Scene::There;
                post.tells.push(Tell::Tracers(scene, self.tracing()));
            }
            Tell::Failed(scene, _) if scene == self.number => mate.scene = Scene::None,
            Tell::Part(part) if part.serial == self.serial => {
                if part.ended && !mate.open.is_empty() {
                    let took = mate.open.remove(0).elapsed();
                    if took < TIME.start {
                        mate.size = (mate.size * 2).min(SIZES.end);
                    } else if took > TIME.end {
                        mate.size = (mate.size / 2).max(SIZES.start);
                    }
                }
                post.tells.extend(leader.accept(*part));
            }
            // Of scenes and pictures that are gone; mates are asked for nothing else.
            Tell::Prepared(..)
            | Tell::Failed(..)
            | Tell::Part(_)
            | Tell::Tracers(..)
            | Tell::Scene { .. }
            | Tell::Picture(_)
            | Tell::Seen(_)
            | Tell::Rays(_)
            | Tell::Refused(_)
            | Tell::Notice(_) => {}
        }
        self.deal(leader, &mut post.asks);
        post
    }

    /// How many tracers have the scene.
    pub fn tracing(&self) -> usize {
        1 + self.mates.iter().filter(|mate| mate.scene == Scene::There).count()
    }

    fn drop_shares(&mut self, asks: &mut Vec<(usize, Ask)>) {
        for (number, mate) in self.mates.iter_mut().enumerate() {
            if !mate.open.is_empty() {
                mate.open.clear();
                asks.push((number, Ask::Stop));
            }
        }
    }

    /// Gives every mate work, as long as there is any.
    fn deal(&mut self, leader: &mut Clerk, asks: &mut Vec<(usize, Ask)>) {
        for (number, mate) in self.mates.iter_mut().enumerate() {
            while mate.scene == Scene::There && mate.open.len() < SHARES {
                let Some(share) = leader.lend(mate.size) else { return };
                mate.open.push(Instant::now());
                asks.push((number, Ask::Help(Box::new(share))));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Request;
    use dotray_render::Antialias;
    use dotray_render::Options;
    use dotray_render::PrepareOptions;
    use dotray_render::Silent;
    use dotray_render::World;
    use dotray_scene::Resolved;
    use dotray_scene::files::Disk;
    use dotray_scene::load::LoadOptions;
    use dotray_scene::load::load_text;
    use dotray_scene::resolve::resolve;
    use std::collections::VecDeque;

    const SCENE: &str = "#camera 0 0 6 0 0 -1 0 1 0 .5 #background .1 .2 .3 #light_point 1 1 1 3 4 5 1 0 0
        #material .1 .1 .1 .5 .4 .3 .6 .6 .6 0 0 0 .5 .3 1.3 -1 !m! #shape_sphere 0 -1 0 0 1.2
        #shape_box 0 1.3 0 0 1 2 1 #shape_cone 0 0 -1.4 1 1 1";

    fn open() -> Ask {
        let files = vec![("a.ray".to_owned(), SCENE.as_bytes().to_vec())];
        Ask::Open { number: 1, path: "a.ray".to_owned(), accel: "bvh".to_owned(), files }
    }

    fn resolved() -> Resolved {
        let scene =
            load_text("a.ray", SCENE.to_owned(), &Disk, &LoadOptions::default()).scene.expect("a scene");
        resolve(scene).resolved.expect("resolved")
    }

    fn request(serial: u64, antialias: Antialias) -> Request {
        let options = Options { width: 201, height: 133, antialias, ..Options::default() };
        Request { serial, camera: resolved().camera, options }
    }

    fn rendered(request: &Request) -> Vec<f32> {
        let world = World::prepare(resolved(), &Disk, &PrepareOptions::default()).expect("a world");
        dotray_render::render(&world, &request.options, &Silent).expect("a picture").image.samples().to_vec()
    }

    /// A leader with its mates, and letters that lie for a while.
    struct Played {
        leader: Clerk,
        crew: Crew,
        mates: Vec<Clerk>,
        letters: Vec<VecDeque<Ask>>,
        /// How many tiles came from mates.
        lent: usize,
    }

    impl Played {
        fn new(count: usize, room: fn() -> usize) -> Self {
            let mates = (0..count).map(|_| Clerk::default()).collect();
            let letters = (0..count).map(|_| VecDeque::new()).collect();
            Self { leader: Clerk::default(), crew: Crew::new(count, room), mates, letters, lent: 0 }
        }

        fn post(&mut self, post: Post) -> Vec<Tell> {
            post.asks.into_iter().for_each(|(mate, ask)| self.letters[mate].push_back(ask));
            post.tells
        }

        fn ask(&mut self, ask: Ask) -> Vec<Tell> {
            let post = self.crew.take(ask, &mut self.leader);
            self.post(post)
        }

        /// A mate takes a letter or traces a portion.
        fn turn(&mut self, number: usize) -> Vec<Tell> {
            let mate = &mut self.mates[number];
            let told: Vec<Tell> = match self.letters[number].pop_front() {
                Some(ask) => mate.handle(ask, &Bundle::default()),
                None => mate.advance().into_iter().collect(),
            };
            let mut tells = Vec::new();
            for tell in told {
                if let Tell::Part(part) = &tell {
                    self.lent += part.tiles.len();
                }
                let post = self.crew.heard(number, tell, &mut self.leader);
                tells.extend(self.post(post));
            }
            tells
        }

        /// Until the picture is finished: these mates work, and the leader every so many'th time.
        fn finish(&mut self, serial: u64, mates: &[usize], leader_every: usize) -> Vec<f32> {
            for round in 0.. {
                let mut tells = Vec::new();
                mates.iter().for_each(|mate| tells.extend(self.turn(*mate)));
                if round % leader_every == 0 {
                    tells.extend(self.leader.advance());
                }
                while let Some(tell) = tells.pop() {
                    let Tell::Picture(sent) = tell else { continue };
                    assert_eq!(sent.serial, serial);
                    if let Some(film) = sent.film {
                        return bytemuck::pod_collect_to_vec(&film);
                    }
                    tells.extend(self.leader.handle(Ask::Shown, &Bundle::default()));
                }
            }
            unreachable!("the picture is finished some day")
        }
    }

    #[test]
    fn the_picture_of_a_crew_is_the_renderers() {
        for antialias in [Antialias::None, Antialias::Adaptive { threshold: 0.1, depth: 2 }] {
            let request = request(5, antialias);
            let expected = rendered(&request);
            let mut played = Played::new(3, || 3);
            assert!(matches!(played.ask(open()).as_slice(), [Tell::Prepared(1, _)]));
            (0..3).for_each(|mate| drop(played.turn(mate)));
            assert_eq!(played.crew.tracing(), 4);
            played.ask(Ask::Draw(Box::new(request)));
            assert!(played.finish(5, &[0, 1, 2], 4) == expected, "{antialias:?}");
            assert!(played.lent > 10, "{}", played.lent);
        }
    }

    #[test]
    fn nobody_waits_for_a_mate_that_is_gone_and_what_is_late_is_dropped() {
        let mut played = Played::new(3, || 2);
        played.ask(open());
        (0..3).for_each(|mate| drop(played.turn(mate)));
        // There was room for two mates.
        assert_eq!(played.crew.tracing(), 3);
        let first = request(1, Antialias::None);
        played.ask(Ask::Draw(Box::new(first.clone())));
        // A mate has work, the picture is dropped, and its part comes late.
        played.turn(0);
        played.mates[0].advance().into_iter().for_each(|tell| {
            let moved = Request { serial: 2, ..first.clone() };
            let post = played.crew.take(Ask::Draw(Box::new(moved)), &mut played.leader);
            post.asks.into_iter().for_each(|(mate, ask)| played.letters[mate].push_back(ask));
            assert!(played.crew.heard(0, tell, &mut played.leader).tells.is_empty());
        });
        // From now on the other one answers no more.
        let expected = rendered(&first);
        assert!(played.finish(2, &[0], 1) == expected);
    }
}
