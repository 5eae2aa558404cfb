// What the two kernels that sort buckets share.

// Records of a bucket up to which one invocation sorts it.
const SORT_SHORT: u32 = 32u;

// What readers need to know of the key is the cell.
fn copy_record(i: u32) {
    let record = records[order[i]];
    sorted[i] = PhotonRecord(record.position, record_code(record), record.flux, record.direction);
}
