//! Calls that make and delete names (OpenGL 4.6 core, sections 4.2.1, 6.1, 8.1, 9.2 and 10.3.1).
//!
//! Deleting 0 or a name that is not used is no error. A deleted object leaves the bindings of the context that deletes
//! it and the containers that are bound there; everything else that refers to it keeps it.

use super::{
    buffers::Buffer,
    containers::VertexArrayObject,
    context::Context,
    framebuffers::FramebufferObject,
    queries::{Query, QueryTarget},
    textures::TextureObject,
};
use crate::{error::Result, texture::TextureKind};

impl Context {
    /// Reserves names of buffers.
    ///
    /// # Errors
    /// For more than 2²⁰ names.
    pub fn gen_buffers(&mut self, count: usize) -> Result<Vec<u32>> {
        self.shared.borrow_mut().buffers.generate(count, "gen_buffers")
    }

    /// Makes buffers without storage.
    ///
    /// # Errors
    /// For more than 2²⁰ names.
    pub fn create_buffers(&mut self, count: usize) -> Result<Vec<u32>> {
        self.shared.borrow_mut().buffers.create(count, "create_buffers", Buffer::new)
    }

    /// Deletes names of buffers; mappings end, but for a buffer that a draw reads which has not ended.
    pub fn delete_buffers(&mut self, names: &[u32]) {
        for name in names {
            let deleted = self.shared.borrow_mut().buffers.delete(*name);
            if let Some(buffer) = deleted {
                if let Ok(mut buffer) = buffer.try_borrow_mut() {
                    buffer.end_mapping();
                }
                self.unbind_buffer(&buffer);
            }
        }
    }

    /// True if the name is that of a buffer: not if it is only reserved.
    pub fn is_buffer(&self, name: u32) -> bool {
        self.shared.borrow().buffers.has_object(name)
    }

    /// Reserves names of textures.
    ///
    /// # Errors
    /// For more than 2²⁰ names.
    pub fn gen_textures(&mut self, count: usize) -> Result<Vec<u32>> {
        self.shared.borrow_mut().textures.generate(count, "gen_textures")
    }

    /// Makes textures of a kind, without storage.
    ///
    /// # Errors
    /// For more than 2²⁰ names.
    pub fn create_textures(&mut self, target: TextureKind, count: usize) -> Result<Vec<u32>> {
        self.shared.borrow_mut().textures.create(count, "create_textures", || TextureObject::new(target))
    }

    /// Deletes names of textures.
    pub fn delete_textures(&mut self, names: &[u32]) {
        for name in names {
            let deleted = self.shared.borrow_mut().textures.delete(*name);
            if let Some(texture) = deleted {
                self.unbind_texture(&texture);
            }
        }
    }

    /// True if the name is that of a texture: not if it is only reserved.
    pub fn is_texture(&self, name: u32) -> bool {
        self.shared.borrow().textures.has_object(name)
    }

    /// Reserves names of vertex arrays.
    ///
    /// # Errors
    /// For more than 2²⁰ names.
    pub fn gen_vertex_arrays(&mut self, count: usize) -> Result<Vec<u32>> {
        self.vertex_arrays.generate(count, "gen_vertex_arrays")
    }

    /// Makes vertex arrays without attributes.
    ///
    /// # Errors
    /// For more than 2²⁰ names.
    pub fn create_vertex_arrays(&mut self, count: usize) -> Result<Vec<u32>> {
        self.vertex_arrays.create(count, "create_vertex_arrays", VertexArrayObject::default)
    }

    /// Deletes names of vertex arrays.
    pub fn delete_vertex_arrays(&mut self, names: &[u32]) {
        for name in names {
            if let Some(array) = self.vertex_arrays.delete(*name) {
                self.unbind_vertex_array(&array);
            }
        }
    }

    /// True if the name is that of a vertex array: not if it is only reserved.
    pub fn is_vertex_array(&self, name: u32) -> bool {
        self.vertex_arrays.has_object(name)
    }

    /// Reserves names of framebuffers.
    ///
    /// # Errors
    /// For more than 2²⁰ names.
    pub fn gen_framebuffers(&mut self, count: usize) -> Result<Vec<u32>> {
        self.framebuffers.generate(count, "gen_framebuffers")
    }

    /// Makes framebuffers without attachments.
    ///
    /// # Errors
    /// For more than 2²⁰ names.
    pub fn create_framebuffers(&mut self, count: usize) -> Result<Vec<u32>> {
        self.framebuffers.create(count, "create_framebuffers", FramebufferObject::default)
    }

    /// Deletes names of framebuffers.
    pub fn delete_framebuffers(&mut self, names: &[u32]) {
        for name in names {
            if let Some(framebuffer) = self.framebuffers.delete(*name) {
                self.unbind_framebuffer(&framebuffer);
            }
        }
    }

    /// True if the name is that of a framebuffer: not if it is only reserved.
    pub fn is_framebuffer(&self, name: u32) -> bool {
        self.framebuffers.has_object(name)
    }

    /// Reserves names of queries.
    ///
    /// # Errors
    /// For more than 2²⁰ names.
    pub fn gen_queries(&mut self, count: usize) -> Result<Vec<u32>> {
        self.queries.names.generate(count, "gen_queries")
    }

    /// Makes queries of a target, with the result 0.
    ///
    /// # Errors
    /// For more than 2²⁰ names.
    pub fn create_queries(&mut self, target: QueryTarget, count: usize) -> Result<Vec<u32>> {
        self.queries.names.create(count, "create_queries", || Query::new(target))
    }

    /// Deletes names of queries. One that is active goes on counting until it is ended, after which nobody can ask for
    /// its result.
    pub fn delete_queries(&mut self, names: &[u32]) {
        for name in names {
            self.queries.names.delete(*name);
        }
    }

    /// True if the name is that of a query: not if it is only reserved.
    pub fn is_query(&self, name: u32) -> bool {
        self.queries.names.has_object(name)
    }
}
