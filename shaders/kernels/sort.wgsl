// What the two kernels that sort buckets share.

// Records of a bucket up to which one invocation sorts it.
const SORT_SHORT: u32 = 32u;
