//! COLLADA: the triangles of the scene that the file instantiates.
//!
//! Read are `triangles`, `polylist`, `polygons`, `trifans` and `tristrips`, placed by the nodes of
//! the instantiated visual scene (`matrix`, `translate`, `rotate`, `scale`, `instance_node`); a
//! file without a scene gives each geometry once, as it stands. Coordinates are multiplied by
//! `unit meter`. `up_axis` is ignored: RViz and MoveIt undo the turn that Assimp makes for it, and
//! the URDFs of this world rely on that. Skins and animations are not read.

use super::{MAX_TRIANGLES, Soup, too_many_triangles};
use crate::error::{FileError, quoted};
use crate::read::text_from_bytes;
use crate::xml;
use roxmltree::Node;
use std::cell::Cell;
use std::collections::HashMap;
use std::path::Path;

/// Nodes within nodes, instances counted: a node that instantiates itself ends here.
const MAX_DEPTH: usize = 64;
/// Elements, numbers and corners looked at, each as often as it is instantiated. What a file holds
/// once is bounded by its bytes; this bounds what references to references multiply it to.
const MAX_STEPS: usize = 50_000_000;
/// An element takes about as long as so many numbers.
const ELEMENT_STEPS: usize = 16;

pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Soup, FileError> {
    let text = text_from_bytes(path, bytes.to_vec())?;
    let document = xml::parse(path, &text)?;
    let root = document.root_element();
    if root.tag_name().name() != "COLLADA" {
        let (line, column) = xml::position(root);
        return Err(FileError::new(path, format!("found <{}>", root.tag_name().name()))
            .at(line, column)
            .expected("<COLLADA>"));
    }
    let by_id: HashMap<&str, Node> = root.descendants().filter_map(|n| Some((n.attribute("id")?, n))).collect();
    let mut reader = Reader { path, by_id, geometries: HashMap::new(), soup: Soup::default(), steps: Cell::new(0) };
    let unit = child(root, "asset").and_then(|a| child(a, "unit"));
    let metres = match unit.and_then(|u| u.attribute("meter").map(|m| (u, m))) {
        None => 1.0,
        Some((unit, text)) => match text.trim().parse::<f64>() {
            Ok(metres) if metres.is_finite() && metres > 0.0 => metres,
            _ => return Err(reader.wrong(unit, format!("unit meter={}", quoted(text))).expected("a positive number")),
        },
    };
    let world = Transform::scaling([metres; 3]);
    let instance = child(root, "scene").and_then(|s| child(s, "instance_visual_scene"));
    match instance {
        Some(instance) => {
            let visual_scene = reader.target(instance, "visual_scene")?;
            reader.children(visual_scene, &world, 0)?;
        }
        None => {
            for library in root.children().filter(|n| n.has_tag_name_local("library_geometries")) {
                for geometry in library.children().filter(|n| n.has_tag_name_local("geometry")) {
                    reader.place(geometry, &world)?;
                }
            }
        }
    }
    Ok(reader.soup)
}

struct Reader<'p, 'd, 't> {
    path: &'p Path,
    by_id: HashMap<&'d str, Node<'d, 't>>,
    /// Read once, however often placed; by the id.
    geometries: HashMap<&'d str, Soup>,
    soup: Soup,
    steps: Cell<usize>,
}

impl<'d, 't> Reader<'_, 'd, 't> {
    fn wrong(&self, node: Node, found: impl Into<String>) -> FileError {
        let (line, column) = xml::position(node);
        FileError::new(self.path, found).at(line, column)
    }

    /// What `url="#id"` or `source="#id"` of `node` names.
    fn target(&self, node: Node<'d, 't>, tag: &str) -> Result<Node<'d, 't>, FileError> {
        let url = node.attribute("url").or_else(|| node.attribute("source")).unwrap_or_default();
        url.strip_prefix('#')
            .and_then(|id| self.by_id.get(id))
            .copied()
            .filter(|n| tag.is_empty() || n.has_tag_name_local(tag))
            .ok_or_else(|| self.wrong(node, format!("names {}, which is not in the file", quoted(url))))
    }

    /// The nodes and geometries below `parent`, of which `world` is the frame.
    fn children(&mut self, parent: Node<'d, 't>, world: &Transform, depth: usize) -> Result<(), FileError> {
        if depth > MAX_DEPTH {
            return Err(self.wrong(parent, "nodes that instantiate each other without end"));
        }
        for element in self.elements(parent)? {
            match element.tag_name().name() {
                "node" => {
                    let inner = world.times(&self.transform(element)?);
                    self.children(element, &inner, depth + 1)?;
                }
                "instance_node" => {
                    let node = self.target(element, "node")?;
                    let inner = world.times(&self.transform(node)?);
                    self.children(node, &inner, depth + 1)?;
                }
                "instance_geometry" => {
                    let geometry = self.target(element, "geometry")?;
                    self.place(geometry, world)?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// A node's own transform: its elements from left to right, the last applied first.
    fn transform(&self, node: Node<'d, 't>) -> Result<Transform, FileError> {
        let mut product = Transform::scaling([1.0; 3]);
        for element in self.elements(node)? {
            let next = match element.tag_name().name() {
                "matrix" => {
                    let m: [f64; 16] = self.fixed_numbers(element)?;
                    Transform { rows: std::array::from_fn(|r| std::array::from_fn(|c| m[4 * r + c])) }
                }
                "translate" => Transform::translation(self.fixed_numbers(element)?),
                "scale" => Transform::scaling(self.fixed_numbers(element)?),
                "rotate" => {
                    let [x, y, z, degrees] = self.fixed_numbers(element)?;
                    Transform::rotation([x, y, z], degrees.to_radians())
                }
                "lookat" | "skew" => {
                    return Err(self
                        .wrong(element, format!("<{}>", element.tag_name().name()))
                        .expected("<matrix>, <translate>, <rotate> or <scale>")
                        .help("export the mesh again with its transforms applied"));
                }
                _ => continue,
            };
            product = product.times(&next);
        }
        Ok(product)
    }

    fn place(&mut self, geometry: Node<'d, 't>, world: &Transform) -> Result<(), FileError> {
        let id = geometry.attribute("id").unwrap_or_default();
        if !self.geometries.contains_key(id) {
            let soup = self.geometry(geometry)?;
            self.geometries.insert(id, soup);
        }
        let Some(part) = self.geometries.get(id) else { return Ok(()) };
        if self.soup.triangles.len() + part.triangles.len() > MAX_TRIANGLES {
            return Err(too_many_triangles(self.path));
        }
        self.count_steps(geometry, part.vertices.len())?;
        let first = self.soup.vertices.len() as u32;
        self.soup.vertices.extend(part.vertices.iter().map(|v| world.point(*v)));
        self.soup.triangles.extend(part.triangles.iter().map(|t| t.map(|i| first + i)));
        // An id that is missing cannot be told from another missing one.
        if id.is_empty() {
            self.geometries.remove(id);
        }
        Ok(())
    }

    fn geometry(&self, geometry: Node<'d, 't>) -> Result<Soup, FileError> {
        let mut soup = Soup::default();
        let Some(mesh) = child(geometry, "mesh") else { return Ok(soup) };
        for primitive in self.elements(mesh)? {
            let kind = primitive.tag_name().name();
            if !matches!(kind, "triangles" | "polylist" | "polygons" | "trifans" | "tristrips") {
                continue;
            }
            let parts = self.elements(primitive)?;
            let inputs: Vec<Node> = parts.iter().copied().filter(|n| n.has_tag_name_local("input")).collect();
            let offset_of =
                |n: &Node| n.attribute("offset").and_then(|o| o.trim().parse::<usize>().ok()).filter(|o| *o < 64);
            let mut stride = 1;
            for input in &inputs {
                stride = stride
                    .max(1 + offset_of(input).ok_or_else(|| self.wrong(*input, "an input without a sensible offset"))?);
            }
            let Some(vertex) = inputs.iter().find(|n| n.attribute("semantic") == Some("VERTEX")) else { continue };
            let offset = offset_of(vertex).unwrap_or(0);
            let vertices = self.target(*vertex, "vertices")?;
            let position = self
                .elements(vertices)?
                .into_iter()
                .find(|n| n.has_tag_name_local("input") && n.attribute("semantic") == Some("POSITION"))
                .ok_or_else(|| self.wrong(vertices, "vertices without a POSITION"))?;
            let first = soup.vertices.len();
            soup.vertices.extend(self.positions(self.target(position, "source")?)?);
            let count = soup.vertices.len() - first;
            for p in parts.into_iter().filter(|n| n.has_tag_name_local("p")) {
                let mut corners: Vec<u32> = Vec::new();
                for (i, word) in text_of(p).split_ascii_whitespace().enumerate() {
                    let index: usize = word
                        .parse()
                        .map_err(|_| self.wrong(p, format!("found {}", quoted(word))).expected("an index"))?;
                    if i % stride == offset {
                        if index >= count {
                            return Err(self.wrong(p, format!("a triangle names corner {index} of {count}")));
                        }
                        corners.push((first + index) as u32);
                    }
                    if corners.len() > 3 * MAX_TRIANGLES {
                        return Err(too_many_triangles(self.path));
                    }
                }
                self.cut(primitive, kind, &corners, &mut soup)?;
                if soup.triangles.len() > MAX_TRIANGLES {
                    return Err(too_many_triangles(self.path));
                }
            }
        }
        Ok(soup)
    }

    /// One `<p>` of a primitive as triangles.
    fn cut(&self, primitive: Node, kind: &str, corners: &[u32], soup: &mut Soup) -> Result<(), FileError> {
        let fan = |soup: &mut Soup, polygon: &[u32]| {
            if let [first, rest @ ..] = polygon {
                soup.triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
            }
        };
        match kind {
            "triangles" => {
                let (triangles, rest) = corners.as_chunks::<3>();
                if !rest.is_empty() {
                    return Err(self
                        .wrong(primitive, format!("{} corners", corners.len()))
                        .expected("three to a triangle"));
                }
                soup.triangles.extend(triangles);
            }
            "polylist" => {
                let counts = child(primitive, "vcount").map(text_of).unwrap_or_default();
                let mut rest = corners;
                for word in counts.split_ascii_whitespace() {
                    let polygon = word.parse::<usize>().ok().and_then(|n| rest.split_at_checked(n));
                    let Some((polygon, after)) = polygon else {
                        return Err(self.wrong(primitive, "vcount names more corners than there are"));
                    };
                    fan(soup, polygon);
                    rest = after;
                }
            }
            "tristrips" => {
                for (i, t) in corners.windows(3).enumerate() {
                    soup.triangles.push(if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] });
                }
            }
            _ => fan(soup, corners),
        }
        Ok(())
    }

    /// The points of a `<source>`, by its accessor.
    fn positions(&self, source: Node<'d, 't>) -> Result<Vec<[f64; 3]>, FileError> {
        self.elements(source)?;
        let accessor = child(source, "technique_common").and_then(|t| child(t, "accessor"));
        let number = |name: &str, default: usize| {
            accessor.and_then(|a| a.attribute(name)).map_or(Some(default), |v| v.trim().parse::<usize>().ok())
        };
        let (Some(stride), Some(offset)) = (number("stride", 3), number("offset", 0)) else {
            return Err(self.wrong(source, "an accessor without a sensible stride and offset"));
        };
        if !(3..=64).contains(&stride) {
            return Err(self.wrong(source, format!("points of stride {stride}")).expected("3: x, y, z"));
        }
        let Some(array) = child(source, "float_array") else {
            return Err(self.wrong(source, "a source of points without a <float_array>"));
        };
        let numbers = self.numbers(array)?;
        Ok(numbers.get(offset..).unwrap_or_default().chunks_exact(stride).map(|p| [p[0], p[1], p[2]]).collect())
    }

    /// A node's elements, counted as steps.
    fn elements(&self, node: Node<'d, 't>) -> Result<Vec<Node<'d, 't>>, FileError> {
        let elements: Vec<Node> = node.children().filter(Node::is_element).collect();
        self.count_steps(node, ELEMENT_STEPS * (elements.len() + 1))?;
        Ok(elements)
    }

    fn count_steps(&self, node: Node, steps: usize) -> Result<(), FileError> {
        self.steps.set(self.steps.get().saturating_add(steps));
        if self.steps.get() > MAX_STEPS {
            return Err(self
                .wrong(node, "parts that are instantiated too often")
                .help("export the mesh again, flattened"));
        }
        Ok(())
    }

    fn numbers(&self, node: Node) -> Result<Vec<f64>, FileError> {
        // A number takes at least two characters.
        self.count_steps(node, text_of(node).len() / 2)?;
        text_of(node)
            .split_ascii_whitespace()
            .map(|w| w.parse().map_err(|_| self.wrong(node, format!("found {}", quoted(w))).expected("a number")))
            .collect()
    }

    fn fixed_numbers<const N: usize>(&self, node: Node) -> Result<[f64; N], FileError> {
        let numbers = self.numbers(node)?;
        let found = numbers.len();
        numbers.try_into().map_err(|_| {
            self.wrong(node, format!("{found} numbers in <{}>", node.tag_name().name())).expected(format!("{N}"))
        })
    }
}

fn text_of<'a>(node: Node<'a, '_>) -> &'a str {
    node.text().unwrap_or_default()
}

fn child<'a, 't>(node: Node<'a, 't>, tag: &str) -> Option<Node<'a, 't>> {
    node.children().find(|n| n.has_tag_name_local(tag))
}

/// COLLADA files come with and without their namespace.
trait LocalName {
    fn has_tag_name_local(&self, name: &str) -> bool;
}

impl LocalName for Node<'_, '_> {
    fn has_tag_name_local(&self, name: &str) -> bool {
        self.is_element() && self.tag_name().name() == name
    }
}

/// The upper three rows of an affine transform.
struct Transform {
    rows: [[f64; 4]; 3],
}

impl Transform {
    fn scaling([x, y, z]: [f64; 3]) -> Self {
        Self { rows: [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]] }
    }

    fn translation([x, y, z]: [f64; 3]) -> Self {
        Self { rows: [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]] }
    }

    /// Rodrigues' formula; an axis of no length turns nothing.
    fn rotation([x, y, z]: [f64; 3], angle: f64) -> Self {
        let length = (x * x + y * y + z * z).sqrt();
        if length == 0.0 {
            return Self::scaling([1.0; 3]);
        }
        let (x, y, z) = (x / length, y / length, z / length);
        let (sin, cos) = angle.sin_cos();
        let k = 1.0 - cos;
        Self {
            rows: [
                [cos + x * x * k, x * y * k - z * sin, x * z * k + y * sin, 0.0],
                [y * x * k + z * sin, cos + y * y * k, y * z * k - x * sin, 0.0],
                [z * x * k - y * sin, z * y * k + x * sin, cos + z * z * k, 0.0],
            ],
        }
    }

    fn times(&self, inner: &Transform) -> Transform {
        let element = |r: usize, c: usize| {
            let sum: f64 = (0..3).map(|k| self.rows[r][k] * inner.rows[k][c]).sum();
            if c == 3 { sum + self.rows[r][3] } else { sum }
        };
        Transform { rows: std::array::from_fn(|r| std::array::from_fn(|c| element(r, c))) }
    }

    fn point(&self, p: [f64; 3]) -> [f64; 3] {
        self.rows.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3])
    }
}
