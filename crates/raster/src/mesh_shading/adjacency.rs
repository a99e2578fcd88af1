//! Which triangles meet at a vertex, as long as they are in no cluster yet.

/// The most entries of a vertex's list that one look at it reads, so that vertices of very many triangles cost no more
/// than others.
const LOOK: usize = 64;

/// For each vertex, the triangles that have it as a corner.
pub(super) struct Adjacency {
    /// Start of each vertex's list, and the end of the last.
    starts: Vec<usize>,
    /// Number of entries at the start of each list that hold only triangles already taken.
    skipped: Vec<usize>,
    triangles: Vec<u32>,
    /// Number of triangles of each vertex that are not taken.
    live: Vec<u32>,
}

impl Adjacency {
    /// Adjacency of a mesh with `vertices` vertices; all indices are below that.
    pub fn new(vertices: usize, triangles: &[[u32; 3]]) -> Self {
        // Lists in one array: count the triangles of each vertex, sum up, then scatter.
        let mut live = vec![0; vertices];
        for triangle in triangles {
            distinct(*triangle).for_each(|v| live[v as usize] += 1);
        }
        let mut starts = Vec::with_capacity(vertices + 1);
        let mut end = 0;
        for &count in &live {
            starts.push(end);
            end += count as usize;
        }
        starts.push(end);
        // Scatter the numbers of triangles into the list of each corner.
        let mut next = starts.clone();
        let mut lists = vec![0; end];
        for (number, triangle) in triangles.iter().enumerate() {
            for v in distinct(*triangle) {
                lists[next[v as usize]] = number as u32;
                next[v as usize] += 1;
            }
        }
        Self { skipped: vec![0; vertices], starts, triangles: lists, live }
    }

    /// Takes a triangle.
    pub fn take(&mut self, triangle: [u32; 3]) {
        distinct(triangle).for_each(|v| self.live[v as usize] -= 1);
    }

    /// Number of triangles of a vertex that are not taken.
    pub fn live(&self, vertex: u32) -> u32 {
        self.live[vertex as usize]
    }

    /// Triangles of a vertex that are not taken, but not more than [`LOOK`] entries of its list are read.
    pub fn around(&mut self, vertex: u32, is_taken: impl Fn(u32) -> bool) -> impl Iterator<Item = u32> {
        let v = vertex as usize;
        let list = &self.triangles[self.starts[v]..self.starts[v + 1]];
        let skipped = &mut self.skipped[v];
        // Skip the leading entries that are taken for good, so that repeated looks stay cheap.
        while list.get(*skipped).is_some_and(|&t| is_taken(t)) {
            *skipped += 1;
        }
        list[*skipped..].iter().copied().take(LOOK).filter(move |&t| !is_taken(t))
    }
}

/// The vertices of a triangle, each once.
pub(super) fn distinct([a, b, c]: [u32; 3]) -> impl Iterator<Item = u32> {
    [(a, true), (b, b != a), (c, c != a && c != b)].into_iter().filter(|v| v.1).map(|v| v.0)
}
