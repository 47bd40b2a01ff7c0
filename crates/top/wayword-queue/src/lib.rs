//! A run that many workers make: its plan, chunks, claims and completion, and the scripts that launch workers.
