use super::table::Row;
pub fn rows() -> Vec<Row> { vec![] }
