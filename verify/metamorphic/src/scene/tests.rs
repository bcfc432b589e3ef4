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
