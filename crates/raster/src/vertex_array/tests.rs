//! Bytes to values, by hand.

use super::{ComponentType::*, Components::*, Conversion::*, *};

const ALL: [ComponentType; 13] =
    [I8, U8, I16, U16, I32, U32, Fixed, F16, F32, F64, Int2_10_10_10, Uint2_10_10_10, Float10_11_11];

fn format(component: ComponentType, components: Components, conversion: Conversion) -> AttributeFormat {
    AttributeFormat { component, components, conversion }
}

const fn at(vertex: u32, instance: u32) -> VertexInput {
    VertexInput { vertex, instance, draw: 0 }
}

/// The attribute of these bytes, as doubles and as floats.
fn both(format: AttributeFormat, bytes: &[u8]) -> ([f64; 4], [f32; 4]) {
    let attribute = Attribute { bytes, format, offset: 0, stride: 0, divisor: 0 };
    let array = VertexArray::new().attribute(5, attribute).unwrap();
    (array.fetch_double(5, at(0, 0), 0).to_array(), array.fetch(5, at(0, 0), 0).to_array())
}

/// Checks the value of bytes, whose number of components is that of the values.
fn check(component: ComponentType, conversion: Conversion, bytes: &[u8], values: &[f64]) {
    let components = [One, Two, Three, Four][values.len() - 1];
    let mut expected = [0.0, 0.0, 0.0, 1.0];
    expected[..values.len()].copy_from_slice(values);
    let (doubles, floats) = both(format(component, components, conversion), bytes);
    assert_eq!(doubles, expected, "{component:?} {conversion:?} {bytes:x?}");
    if conversion != Integer {
        assert_eq!(floats, expected.map(|x| x as f32));
    } else if values.iter().any(|x| *x > f64::from(i32::MAX)) {
        assert_eq!(floats.map(f32::to_bits), expected.map(|x| x as u32));
    } else {
        assert_eq!(floats.map(|x| x.to_bits().cast_signed()), expected.map(|x| x as i32));
    }
}

#[test]
fn integers_have_their_value_or_their_share_of_the_largest() {
    // Equation 2.1: c / (2^b − 1).
    check(U8, Float, &[0, 1, 128, 255], &[0.0, 1.0, 128.0, 255.0]);
    check(U8, Normalized, &[0, 51, 255], &[0.0, 0.2, 1.0]);
    check(U16, Float, &[0xff, 0xff, 0x34, 0x12], &[65535.0, 4660.0]);
    check(U16, Normalized, &[0xff, 0xff, 0x33, 0x33], &[1.0, 0.2]);
    check(U32, Float, &[0xff; 4], &[4_294_967_295.0]);
    check(U32, Normalized, &[0xff, 0xff, 0xff, 0xff, 0, 0, 0, 0x80], &[1.0, 2_147_483_648.0 / 4_294_967_295.0]);
    // Equation 2.2: max(c / (2^(b − 1) − 1), −1), so that −2^(b − 1) and the next code are both −1.
    check(I8, Float, &[0x80, 0x81, 0x7f], &[-128.0, -127.0, 127.0]);
    check(I8, Normalized, &[0x80, 0x81, 0x00, 0x7f], &[-1.0, -1.0, 0.0, 1.0]);
    check(I8, Normalized, &[0xff], &[-1.0 / 127.0]);
    check(I16, Float, &[0x00, 0x80, 0xff, 0x7f], &[-32768.0, 32767.0]);
    check(I16, Normalized, &[0x00, 0x80, 0x01, 0x80, 0xff, 0x7f], &[-1.0, -1.0, 1.0]);
    check(I32, Float, &[0, 0, 0, 0x80, 0xfe, 0xff, 0xff, 0xff], &[-2_147_483_648.0, -2.0]);
    let bytes = [0, 0, 0, 0x80, 1, 0, 0, 0x80, 0xff, 0xff, 0xff, 0x7f, 1, 0, 0, 0];
    check(I32, Normalized, &bytes, &[-1.0, -1.0, 1.0, 1.0 / 2_147_483_647.0]);
}

#[test]
fn integers_reach_integer_inputs_as_bits() {
    check(I8, Integer, &[0x80, 0xff], &[-128.0, -1.0]);
    check(U8, Integer, &[0x80, 0xff], &[128.0, 255.0]);
    check(I16, Integer, &[0xfe, 0xff], &[-2.0]);
    check(U16, Integer, &[0xfe, 0xff], &[65534.0]);
    check(I32, Integer, &[0xfd, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f], &[-3.0, 2_147_483_647.0]);
    check(U32, Integer, &[0xfd, 0xff, 0xff, 0xff], &[4_294_967_293.0]);
    // Numbers beyond the 24 bits of a float's mantissa are whole, and the missing w is the integer 1.
    let (_, floats) = both(format(U32, One, Integer), &[0x01, 0x00, 0x00, 0x81]);
    assert_eq!(floats.map(f32::to_bits), [0x8100_0001, 0, 0, 1]);
}

#[test]
fn floats_and_fixed_point_numbers_are_not_normalised() {
    for conversion in [Float, Normalized] {
        // 1.0, −2.0 and the largest half, 65504.
        check(F16, conversion, &[0x00, 0x3c, 0x00, 0xc0, 0xff, 0x7b], &[1.0, -2.0, 65504.0]);
        check(F32, conversion, &[0, 0, 0x80, 0x3f, 0, 0, 0x20, 0xc1], &[1.0, -10.0]);
        check(F64, conversion, &[0, 0, 0, 0, 0, 0, 0xf8, 0x3f], &[1.5]);
        // 16.16: 1.5, −1, 2⁻¹⁶.
        let bytes = [0x00, 0x80, 0x01, 0x00, 0x00, 0x00, 0xff, 0xff, 0x01, 0x00, 0x00, 0x00];
        check(Fixed, conversion, &bytes, &[1.5, -1.0, 1.0 / 65536.0]);
    }
    // Doubles keep what floats do not have.
    check(F64, Long, &0.1f64.to_le_bytes(), &[0.1]);
    let (doubles, floats) = both(format(F64, One, Long), &(1.0 + f64::EPSILON).to_le_bytes());
    assert_eq!((doubles[0], floats[0]), (1.0 + f64::EPSILON, 1.0));
}

#[test]
fn packed_components_lie_from_the_lowest_bit_on() {
    // x = 1, y = 2, z = 1023 (or −1), w = 2 (or −2).
    let word = 1u32 | 2 << 10 | 1023 << 20 | 2 << 30;
    check(Uint2_10_10_10, Float, &word.to_le_bytes(), &[1.0, 2.0, 1023.0, 2.0]);
    check(Int2_10_10_10, Float, &word.to_le_bytes(), &[1.0, 2.0, -1.0, -2.0]);
    check(Uint2_10_10_10, Normalized, &word.to_le_bytes(), &[1.0 / 1023.0, 2.0 / 1023.0, 1.0, 2.0 / 3.0]);
    // Lowest, lowest but one, largest; w = −2, which the rule of the maximum makes −1, and 1.
    let word = 0x200u32 | 0x201 << 10 | 0x1ff << 20 | 2 << 30;
    check(Int2_10_10_10, Normalized, &word.to_le_bytes(), &[-1.0, -1.0, 1.0, -1.0]);
    check(Int2_10_10_10, Normalized, &(1u32 << 30).to_le_bytes(), &[0.0, 0.0, 0.0, 1.0]);
    // Floats of 11, 11 and 10 bits: 1.0 is exponent 15, 0.5 exponent 14, the last has one bit of mantissa less.
    let word = 0x3c0u32 | 0x380 << 11 | 0x1e8 << 22;
    check(Float10_11_11, Float, &word.to_le_bytes(), &[1.0, 0.5, 1.25]);
    // BGRA: the first component is z.
    assert_eq!(both(format(U8, Bgra, Normalized), &[0, 51, 255, 102]).0, [1.0, 0.2, 0.0, 0.4]);
    let word = 1023u32 | 3 << 30;
    assert_eq!(both(format(Uint2_10_10_10, Bgra, Normalized), &word.to_le_bytes()).0, [0.0, 0.0, 1.0, 1.0]);
    assert_eq!(both(format(Int2_10_10_10, Bgra, Normalized), &0x1ffu32.to_le_bytes()).0, [0.0, 0.0, 1.0, 0.0]);
}

/// Each type with each number of components and each conversion: those of table 10.3 are taken, no other.
#[test]
fn formats_are_those_of_the_table() {
    for component in ALL {
        for components in [One, Two, Three, Four, Bgra] {
            for conversion in [Float, Normalized, Integer, Long] {
                let packed = matches!(component, Int2_10_10_10 | Uint2_10_10_10);
                let of_components = match component {
                    U8 => components != Bgra || conversion == Normalized,
                    Float10_11_11 => components == Three,
                    _ if packed => components == Four || components == Bgra && conversion == Normalized,
                    _ => components != Bgra,
                };
                let of_conversion = match conversion {
                    Float | Normalized => true,
                    Integer => matches!(component, I8 | U8 | I16 | U16 | I32 | U32),
                    Long => component == F64,
                };
                let format = format(component, components, conversion);
                let attribute = Attribute { bytes: &[], format, offset: 0, stride: 0, divisor: 0 };
                let taken = VertexArray::new().attribute(0, attribute).is_ok();
                assert_eq!(taken, of_components && of_conversion, "{format:?}");
            }
        }
    }
}

#[test]
fn attributes_are_fetched_by_offset_stride_and_divisor() {
    // Position as three floats, colour as four normalised bytes, a signed short, 18 bytes apart, from the fifth on.
    let mut bytes = vec![0xee; 5];
    for vertex in 0..4i16 {
        bytes.extend((0..3).flat_map(|axis| (f32::from(vertex) + 0.25 * axis as f32).to_le_bytes()));
        bytes.extend([0, 51, 102, 255]);
        bytes.extend((-100 * vertex).to_le_bytes());
    }
    let part =
        |format, offset: usize, divisor| Attribute { bytes: &bytes, format, offset: 5 + offset, stride: 18, divisor };
    let (colors, short) = (format(U8, Four, Normalized), format(I16, One, Float));
    let array = VertexArray::new()
        .attribute(0, part(AttributeFormat::floats(Three), 0, 0))
        .and_then(|a| a.attribute(3, part(colors, 12, 0)))
        .and_then(|a| a.attribute(4, part(short, 16, 2)))
        .unwrap()
        .constant(7, Vec4::splat(5.0));
    assert_eq!(array.fetch(0, at(2, 0), 0), Vec4::new(2.0, 2.25, 2.5, 1.0));
    assert_eq!(array.fetch(3, at(1, 0), 0), Vec4::new(0.0, 0.2, 0.4, 1.0));
    // Two instances share a value; the base instance moves the element by itself.
    assert_eq!([0, 1, 2, 3, 6].map(|i| array.fetch(4, at(9, i), 0).x), [0.0, 0.0, -100.0, -100.0, -300.0]);
    assert_eq!([1, 2, 3, 4].map(|i| array.fetch(4, at(9, i), 1).x), [-100.0, -100.0, -200.0, -200.0]);
    assert_eq!((array.fetch(7, at(0, 0), 0), array.fetch(8, at(0, 0), 0)), (Vec4::splat(5.0), Vec4::W));
    assert_eq!(array.fetch_double(7, at(0, 0), 0), DVec4::splat(5.0));
    // Beyond the bytes, also where numbers overflow.
    assert_eq!((array.fetch(0, at(4, 0), 0), array.fetch(0, at(u32::MAX, 0), 0)), (Vec4::W, Vec4::W));
    let wide = Attribute { stride: usize::MAX, ..part(short, 0, 0) };
    assert_eq!(VertexArray::new().attribute(0, wide).unwrap().fetch(0, at(3, 0), 0), Vec4::W);
    // A stride of 0 repeats the first.
    let repeated = Attribute { stride: 0, ..part(short, 16 + 18, 0) };
    assert_eq!(VertexArray::new().attribute(0, repeated).unwrap().fetch(0, at(3, 0), 0).x, -100.0);
    assert!(VertexArray::new().attribute(40, part(short, 0, 0)).is_err());
}
