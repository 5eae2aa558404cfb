//! Prints the JSON Schema of scene files:
//! `cargo run --release --example schema > scenes/schema.json`.

fn main() {
    print!("{}", caustica::low_level::scene::schema_json());
}
