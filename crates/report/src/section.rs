//! Sections of a report that a program adds.

use super::ReportCase;

/// Table of a report with a header and rows of as many cells; the first cell of a row is its name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReportTable {
    /// Names of the columns.
    pub header: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<String>>,
}

/// Part of a section of a report.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ReportItem {
    /// Text.
    Paragraph(String),
    /// Table.
    Table(ReportTable),
}

/// Section of the report of a sweep, beside those that every report has; for [`write_report_with`](super::write_report_with).
///
/// ```
/// use powerhouse_report::{ReportCase, ReportItem, ReportSection};
/// /// The number of cases.
/// struct Count;
/// impl ReportSection for Count {
///     fn title(&self) -> &str {
///         "Number of cases"
///     }
///     fn items(&self, cases: &[ReportCase]) -> Vec<ReportItem> {
///         vec![ReportItem::Paragraph(format!("{} cases.", cases.len()))]
///     }
/// }
/// assert!(!Count.items(&[]).is_empty());
/// ```
pub trait ReportSection {
    /// Title.
    fn title(&self) -> &str;
    /// Content by the results of the finished cases, in the order of the scene; empty if the section is not one for this
    /// sweep, and is left out.
    fn items(&self, cases: &[ReportCase]) -> Vec<ReportItem>;
    /// Whether the report has no general sections of peaks, histories and pictures if it has this one; false by default.
    fn replaces_results(&self) -> bool {
        false
    }
}
