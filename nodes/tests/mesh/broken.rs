//! Small valid files cut off at every byte, and with bytes and bits changed: read or refused, never
//! worse.

use crate::measure::read;
use std::sync::Arc;

/// Xorshift by Marsaglia (2003), so that every run breaks files alike.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % sides as u64) as usize
    }
}

fn check(extension: &str, bytes: &[u8], side: &[u8]) {
    let side: Arc<[u8]> = Arc::from(side);
    let broken = |name: &str, bytes: &[u8]| {
        read(name, extension, bytes, &|_| Some(side.clone())).result.is_ok()
    };
    assert!(broken("whole", bytes), "the file should be valid");
    let mut n_read = 0;
    for end in 0..bytes.len() {
        n_read += usize::from(broken(&format!("cut off at {end}"), &bytes[..end]));
    }
    let mut dice = Dice(0x5eed);
    for round in 0..1500 {
        let mut copy = bytes.to_vec();
        for _ in 0..1 + round % 4 {
            let at = dice.roll(copy.len());
            match dice.roll(4) {
                0 => copy[at] ^= 1 << dice.roll(8),
                1 => copy[at] = dice.roll(256) as u8,
                // Digits and signs make numbers that are wrong but well written.
                2 => copy[at] = b"0123456789-.e\",:{}[]/\\ \n"[dice.roll(24)],
                _ => {
                    copy.remove(at);
                }
            }
        }
        n_read += usize::from(broken(&format!("round {round}"), &copy));
    }
    println!("{extension}: {n_read} of {} were read", bytes.len() + 1500);
}

const OBJ: &str = "# two parts\nmtllib a.mtl\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0\nv .5 .25 0\n\
    v 0 1e0 0\nvt 0 0\nvt 1 0 0\nvt 1 1\nvn 0 0 1\no left\nusemtl skin\nf 1/1/1 2/2/1 3/3/1 \\\n\
    4/3/1 5/3/1\ng right\ns off\nusemtl hair\nl 1 2\nf -1// -2// -3//\nf 1 3 5\n";

const JSON: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[
    {"mesh":0,"children":[1],"rotation":[0,0,0.6,0.8],"weights":[0.5]},
    {"mesh":0,"name":"b","skin":0,"scale":[-1,1,1]}],
    "skins":[{"joints":[0,1],"inverseBindMatrices":7}],
    "materials":[{"name":"skin"}],"meshes":[{"primitives":[
    {"attributes":{"POSITION":0,"TEXCOORD_0":1,"COLOR_0":2,"JOINTS_0":5,"WEIGHTS_0":6},"indices":3,
    "material":0,"targets":[{"POSITION":4}]},
    {"attributes":{"POSITION":4},"mode":5}],"weights":[-1]}],"accessors":[
    {"bufferView":0,"componentType":5126,"type":"VEC3","count":4},
    {"bufferView":0,"byteOffset":12,"componentType":5126,"type":"VEC2","count":4},
    {"bufferView":0,"byteOffset":20,"componentType":5121,"type":"VEC3","count":4,"normalized":true},
    {"bufferView":1,"componentType":5123,"type":"SCALAR","count":6},
    {"componentType":5126,"type":"VEC3","count":4,"sparse":{"count":2,
     "indices":{"bufferView":1,"byteOffset":2,"componentType":5123},
     "values":{"bufferView":0,"byteOffset":24}}},
    {"bufferView":2,"componentType":5121,"type":"VEC4","count":4},
    {"bufferView":2,"byteOffset":16,"componentType":5121,"type":"VEC4","count":4,"normalized":true},
    {"bufferView":2,"byteOffset":32,"componentType":5126,"type":"MAT4","count":2}],
    "bufferViews":[{"buffer":0,"byteLength":96,"byteStride":24},
    {"buffer":0,"byteOffset":96,"byteLength":12},{"buffer":0,"byteOffset":108,"byteLength":160}],
    "buffers":[{@"byteLength":268}]}"#;

fn numbers() -> Vec<u8> {
    let mut bytes = Vec::new();
    for [x, y] in [[0_f32, 0_f32], [1., 0.], [1., 1.], [0., 1.]] {
        for value in [x, y, 0.0, x, y] {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend([(x * 255.0) as u8, (y * 51.0) as u8, 0, 0]);
    }
    for index in [0_u16, 1, 2, 0, 2, 3] {
        bytes.extend(index.to_le_bytes());
    }
    bytes.extend([0, 1, 0, 0].repeat(4));
    bytes.extend([51, 204, 0, 0].repeat(4));
    for joint in [0.0_f32, 1.0] {
        for i in 0..16 {
            let identity = if i % 5 == 0 { 1.0 } else { 0.0 };
            bytes.extend(if i == 12 { joint } else { identity }.to_le_bytes());
        }
    }
    bytes
}

#[test]
fn a_broken_obj_is_read_or_refused() {
    check("obj", OBJ.as_bytes(), &[]);
}

#[test]
fn a_broken_gltf_is_read_or_refused() {
    check("gltf", JSON.replace('@', r#""uri":"a.bin","#).as_bytes(), &numbers());
}

#[test]
fn a_broken_glb_is_read_or_refused() {
    let mut json = JSON.replace('@', "").into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut glb = [b"glTF".as_slice(), &[2, 0, 0, 0, 0, 0, 0, 0]].concat();
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", numbers())] {
        glb.extend((chunk.len() as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(chunk);
    }
    let length = glb.len() as u32;
    glb[8..12].copy_from_slice(&length.to_le_bytes());
    check("glb", &glb, &[]);
}
