fn main() {
    println!(
        "{}",
        serde_json::to_string_pretty(&schemars::schema_for!(caustica::scene::file::SceneFile)).unwrap()
    );
}
