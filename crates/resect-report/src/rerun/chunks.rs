//! What a recording is made of, numbered in its order: the SDK numbers by the clock and at random, and no two files of the
//! same data would be alike.

use re_chunk::{Chunk, ChunkId, ChunkResult, RowId, TimeColumn};
use re_log_encoding::{EncodeError, Encoder};
use re_log_types::external::re_tuid::Tuid;
use re_log_types::{
    ArrowMsg, EntityPath, LogMsg, SetStoreInfo, StoreId, StoreInfo, StoreSource, TimePoint,
};
use re_sdk_types::{AsComponents, SerializedComponentColumn};

/// Everything that is logged into one store, in its order.
#[derive(Default)]
pub struct Chunks {
    all: Vec<Chunk>,
}

impl Chunks {
    /// The number of the next chunk; what is in it counts on from there.
    fn next_id(&self) -> Tuid {
        Tuid::from_nanos_and_inc(self.all.len() as u64 + 1, 0)
    }

    pub fn log_static(
        &mut self,
        path: impl Into<EntityPath>,
        what: &dyn AsComponents,
    ) -> ChunkResult<()> {
        self.log(path, TimePoint::STATIC, what)
    }

    pub fn log(
        &mut self,
        path: impl Into<EntityPath>,
        at: TimePoint,
        what: &dyn AsComponents,
    ) -> ChunkResult<()> {
        let id = self.next_id();
        let chunk = Chunk::builder_with_id(ChunkId::from_tuid(id), path);
        self.all.push(chunk.with_archetype(RowId::from_tuid(id), at, what).build()?);
        Ok(())
    }

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

    /// What says that there is a store, and then all that is in it.
    pub fn messages(&self, store_id: &StoreId) -> ChunkResult<Vec<LogMsg>> {
        let source = StoreSource::Other(concat!("resect ", env!("CARGO_PKG_VERSION")).to_owned());
        let info = StoreInfo::new(store_id.clone(), source);
        let row_id = Tuid::from_nanos_and_inc(0, 1);
        let mut messages = vec![LogMsg::SetStoreInfo(SetStoreInfo { row_id, info })];
        for chunk in &self.all {
            let message: ArrowMsg = chunk.to_arrow_msg()?;
            messages.push(LogMsg::ArrowMsg(store_id.clone(), message));
        }
        Ok(messages)
    }
}

/// The bytes of a file.
///
/// It ends without the SDK's table of contents, in which the stores stand in an order by chance; viewers read the file
/// from its beginning, as they read all files before there was one.
pub fn bytes<'a>(messages: impl IntoIterator<Item = &'a LogMsg>) -> Result<Vec<u8>, EncodeError> {
    let mut encoder = Encoder::local()?;
    encoder.do_not_emit_footer();
    for message in messages {
        encoder.append(message)?;
    }
    encoder.finish()?;
    encoder.into_inner()
}
