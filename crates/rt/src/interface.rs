//! Types that the shaders of a pipeline exchange.

/// The types that the shaders of a pipeline exchange. A marker type of the caller's implements it.
pub trait Interface: 'static {
    /// Ray payload: written by hit and miss shaders, read by the shader that traced the ray.
    type Payload;
    /// Attributes of a hit that an intersection shader reports beyond its distance and kind.
    type Attributes: Copy;
    /// Parameter of callable shaders, passed in and back.
    type Parameter;
    /// Local data of records of shader tables.
    type Local: Sync;
    /// Output of a ray-generation shader for each launch id. The default stands where its record is null.
    type Output: Default + Send;
}
