//! What a download tells while it runs.

/// Is told how far a download is.
pub trait Progress {
    /// So many bytes of a file are here, of `total` where the hub has said how many there are.
    fn bytes(&self, file: &str, done: u64, total: Option<u64>);

    /// Another process fetches this file; it is waited for.
    fn waiting(&self, file: &str) {
        let _ = file;
    }
}

/// Tells nobody.
impl Progress for () {
    fn bytes(&self, _: &str, _: u64, _: Option<u64>) {}
}
