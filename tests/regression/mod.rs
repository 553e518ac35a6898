//! Stored results. `LOG.md` states the reason of each of their changes.

mod cavern;
