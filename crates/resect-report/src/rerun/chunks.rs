//! Chunks of a recording, numbered in their order.
//!
//! [`rerun::RecordingStream`] numbers its rows by the clock and at random, so two files of the same data would differ.
//! Chunks with given numbers and a given store make the bytes the same.

use rerun::external::re_log_encoding::{EncodeError, Encoder};
use rerun::external::re_log_types::{SetStoreInfo, StoreInfo, StoreSource};
use rerun::external::re_tuid::Tuid;
use rerun::log::{Chunk, ChunkId, ChunkResult, LogMsg, RowId, TimeColumn};
use rerun::{AsComponents, EntityPath, SerializedComponentColumn, StoreId, TimePoint};

/// Chunks logged into one store, in their order.
#[derive(Default)]
pub struct Chunks {
    all: Vec<Chunk>,
}

impl Chunks {
    /// Returns the number of the next chunk; its rows continue from there.
    fn next_id(&self) -> Tuid {
        Tuid::from_nanos_and_inc(self.all.len() as u64 + 1, 0)
    }

    /// Logs an archetype that is valid at all times.
    pub fn log_static(
        &mut self,
        path: impl Into<EntityPath>,
        archetype: &dyn AsComponents,
    ) -> ChunkResult<()> {
        self.log(path, TimePoint::STATIC, archetype)
    }

    /// Logs an archetype at a time.
    pub fn log(
        &mut self,
        path: impl Into<EntityPath>,
        time: TimePoint,
        archetype: &dyn AsComponents,
    ) -> ChunkResult<()> {
        let id = self.next_id();
        let chunk = Chunk::builder_with_id(ChunkId::from_tuid(id), path);
        self.all.push(chunk.with_archetype(RowId::from_tuid(id), time, archetype).build()?);
        Ok(())
    }

    /// Logs columns, one row for each time.
    pub fn send_columns(
        &mut self,
        path: impl Into<EntityPath>,
        times: TimeColumn,
        columns: impl IntoIterator<Item = SerializedComponentColumn>,
    ) -> ChunkResult<()> {
        let id = ChunkId::from_tuid(self.next_id());
        let times = std::iter::once((*times.timeline().name(), times)).collect();
        let columns = columns.into_iter().collect();
        self.all.push(Chunk::from_auto_row_ids(id, path.into(), times, columns)?);
        Ok(())
    }

    /// Returns the messages that define a store and fill it.
    pub fn messages(&self, store_id: &StoreId) -> ChunkResult<Vec<LogMsg>> {
        let source = StoreSource::Other(concat!("resect ", env!("CARGO_PKG_VERSION")).to_owned());
        let info = StoreInfo::new(store_id.clone(), source);
        let row_id = Tuid::from_nanos_and_inc(0, 1);
        let mut messages = vec![LogMsg::SetStoreInfo(SetStoreInfo { row_id, info })];
        for chunk in &self.all {
            messages.push(LogMsg::ArrowMsg(store_id.clone(), chunk.to_arrow_msg()?));
        }
        Ok(messages)
    }
}

/// Encodes messages as a file.
///
/// The file has no footer: the SDK orders the stores in it at random. Viewers read such files from the beginning.
pub fn encode(messages: &[LogMsg]) -> Result<Vec<u8>, EncodeError> {
    let mut encoder = Encoder::local()?;
    encoder.do_not_emit_footer();
    for message in messages {
        encoder.append(message)?;
    }
    encoder.finish()?;
    encoder.into_inner()
}
