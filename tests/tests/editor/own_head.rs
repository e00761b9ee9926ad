//! From the first start to a cornrow that the user drew on their own head: every action counted, by mouse alone and by pen
//! alone.

use super::harness::settle;
use super::story::{Hand, Story};
use coif_tests::{Folder, shared};

/// The most actions it may take.
const MOST: usize = 15;

#[test]
fn a_cornrow_on_ones_own_head_takes_few_actions_by_mouse_or_by_pen() {
    const NAME: &str = "a_cornrow_on_ones_own_head_takes_few_actions_by_mouse_or_by_pen";
    let Some(mesh) = shared(NAME, "data/ict_head/generic_neutral_mesh.obj") else { return };
    for hand in [Hand::Mouse, Hand::Pen] {
        let home = Folder::new(NAME);
        std::fs::create_dir_all(home.path("heads")).expect("a folder");
        std::fs::copy(&mesh, home.path("heads/my_head.obj")).expect("a head of one's own");
        let mut story = Story::begin("own-head", hand, &home);
        settle(&mut story.ui);
        story.picture("1-start");
        story.click("Empty head");
        // Where one's heads lie: the browser begins there, as it does after the first time.
        story.ui.state_mut().state.file.folder = home.path("heads");
        story.click("File");
        story.click("Own head…");
        story.click("my_head.obj");
        story.click("Open");
        settle(&mut story.ui);
        story.picture("2-head");
        story.click("Accept");
        story.click("Recipes");
        story.click("Cornrows");
        settle(&mut story.ui);
        story.draw(&[(-0.05, -0.34), (0.08, -0.36), (0.16, -0.28)]);
        story.sees_hair(100);
        story.picture("3-row");
        assert!(story.actions <= MOST, "{} actions: {:?}", story.actions, story.took);
        println!("{} actions: {}", story.actions, story.took.join(", "));
    }
}
