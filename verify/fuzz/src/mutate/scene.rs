//! Random scenes, which are drawn whole instead of mutated, and smaller ones.

use super::input::Input;
use fastrand::Rng;
use mtled_metamorphic::scene::Scene;

/// A scene at random as an input; none where it has no text.
pub(crate) fn drawn_scene(rng: &mut Rng) -> Input {
    as_input(&Scene::draw(rng))
}

/// Scenes that are a little smaller than that of an input.
pub(crate) fn smaller_scenes(input: &Input) -> Vec<Input> {
    let text = String::from_utf8_lossy(&input.bytes);
    let scene = Scene::from_text(&text);
    scene.map(|scene| scene.smaller().iter().map(as_input).collect()).unwrap_or_default()
}

fn as_input(scene: &Scene) -> Input {
    Input::new(scene.text().unwrap_or_default(), "toml")
}
