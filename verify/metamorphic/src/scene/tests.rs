use super::*;
use fastrand::Rng;

#[test]
fn a_scene_comes_back_from_its_text() {
    let mut rng = Rng::with_seed(1);
    for _ in 0..200 {
        let scene = Scene::draw(&mut rng);
        let text = scene.text().unwrap();
        assert_eq!(Scene::from_text(&text).unwrap(), scene, "{text}");
    }
}

#[test]
fn the_same_number_gives_the_same_scenes() {
    let draw = |seed| Scene::draw(&mut Rng::with_seed(seed));
    assert_eq!(draw(7), draw(7));
    assert_ne!(draw(7), draw(8));
}

#[test]
fn a_scene_gets_no_smaller_for_ever() {
    let mut rng = Rng::with_seed(2);
    for _ in 0..20 {
        let mut scene = Scene::draw(&mut rng);
        let mut steps = 0;
        while let Some(next) = scene.smaller().into_iter().next() {
            scene = next;
            steps += 1;
            assert!(steps < 100, "{scene:?}");
        }
    }
}

/// What a scene may have besides: springs, a hole, what fills it, memory, tension, an obstacle that
/// moves and one that rubs.
fn features(scene: &Scene) -> [bool; 7] {
    [
        scene.bed.is_some(),
        scene.form.has_hole(),
        scene.filling.is_some(),
        scene.memory.is_some(),
        scene.tension.is_some(),
        scene.obstacle.is_some_and(|wall| wall.drift.is_some()),
        scene.obstacle.is_some_and(|wall| wall.rubs != Rubs::Free),
    ]
}

#[test]
fn every_feature_is_drawn_now_and_then_and_can_be_dropped() {
    let mut rng = Rng::with_seed(4);
    let (count, mut drawn, mut plain) = (2000, [0; 7], 0);
    for _ in 0..count {
        let scene = Scene::draw(&mut rng);
        let own = features(&scene);
        plain += usize::from(own == [false; 7]);
        let smaller = scene.smaller();
        for (n, has) in own.into_iter().enumerate() {
            drawn[n] += usize::from(has);
            let dropped = || smaller.iter().any(|scene| !features(scene)[n]);
            assert!(!has || dropped(), "feature {n} of {scene:?}");
        }
    }
    assert!(drawn.iter().all(|drawn| (count / 50..count / 4).contains(drawn)), "{drawn:?}");
    assert!(plain > count / 3, "{plain}");
}
