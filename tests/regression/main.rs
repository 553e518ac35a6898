//! Results that were stored once. `LOG.md` says why each of them moved since.

mod cavern;
