//! What is built on whole scenes: checks, predictions and the free-field self-check.
