//! Readers and writers of the field's dataset formats: R2R, REVERIE, RxR, VLN-CE and Wayword's own JSONL.
