// Shared by the two kernels that sort buckets.

// Greatest number of records in a bucket that one invocation sorts; longer buckets go to
// `grid_sort_long`.
const SORT_SHORT: u32 = 32u;

// Copies a record to its sorted place and replaces the key by the cell's code, which is what
// readers need.
fn copy_record(i: u32) {
    let record = records[order[i]];
    sorted[i] = PhotonRecord(record.position, record_code(record), record.flux, record.direction);
}
