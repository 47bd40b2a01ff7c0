//! Reads textures: PNG and JPEG, and Basis as HM3D uses it (`GOOGLE_texture_basis`); and how Habitat looks each up.

use super::asset::GltfAsset;
use basisu::{DecodeFlags, TargetFormat, Transcoder};
use gltf::json::{
    texture::{MagFilter, MinFilter},
    validation::Checked,
};
use std::io::Cursor;
use wayword_core::contain_panics::run_decoder;
use wayword_render::{MAX_TEXTURE_SIDE, Texture, TextureFilter};

/// Texels (pixels of a texture) that any picture may have.
const FREE_TEXELS: u64 = 1 << 20;
/// Further texels for each byte of the file: compression shrinks pictures of one colour to a 300th, and real files are
/// less uniform.
const TEXELS_PER_BYTE: u64 = 512;

/// Reads the texture with this number, and how it is looked up.
pub(super) fn read_texture(asset: &GltfAsset, number: usize) -> Result<(Texture, TextureFilter), String> {
    let texture = asset.root.textures.get(number).ok_or_else(|| format!("texture {number} does not exist"))?;
    let basis = texture.extensions.as_ref().and_then(|all| all.others.get("GOOGLE_texture_basis"));
    let basis = basis.and_then(|basis| basis.get("source")).and_then(serde_json::Value::as_u64);
    let other = || texture.extensions.as_ref().and_then(|all| all.others.keys().next());
    if basis.is_none()
        && asset.root.images.get(texture.source.value()).is_none()
        && let Some(other) = other()
    {
        return Err(format!("texture {number}: is only in the format of {other:.60}, which cannot be read"));
    }
    let source = basis.and_then(|source| usize::try_from(source).ok()).unwrap_or(texture.source.value());
    let wrong = |reason: String| format!("image {source}: {reason}");
    let image = asset.root.images.get(source).ok_or_else(|| wrong("does not exist".to_owned()))?;
    let file_bytes;
    let bytes = match (&image.buffer_view, &image.uri) {
        (Some(view), _) => asset.view_bytes(*view).map_err(wrong)?.1,
        (None, Some(uri)) => {
            file_bytes = asset.read_adjacent(uri).map_err(wrong)?;
            &file_bytes
        }
        (None, None) => return Err(wrong("has no bytes".to_owned())),
    };
    let DecodedPicture { texture: texels, has_levels } = decode_texture(bytes).map_err(wrong)?;
    let filter = match wanted_filter(asset, texture) {
        TextureFilter::Trilinear if !has_levels => TextureFilter::Bilinear,
        wanted => wanted,
    };
    Ok((texels, filter))
}

/// A picture, and whether Habitat has smaller copies of it for surfaces far away.
struct DecodedPicture {
    texture: Texture,
    has_levels: bool,
}

/// The lookup that a texture's sampler asks for. Without a sampler, or without `minFilter` in it, Habitat uses smaller copies
/// (Magnum's `GltfImporter`). Where they are used at all, two of them are blended, though a sampler may ask for the nearer one.
fn wanted_filter(asset: &GltfAsset, texture: &gltf::json::Texture) -> TextureFilter {
    let sampler = texture.sampler.and_then(|sampler| asset.root.samplers.get(sampler.value()));
    let unblended = sampler.is_some_and(|it| matches!(it.mag_filter, Some(Checked::Valid(MagFilter::Nearest))));
    match sampler.and_then(|sampler| sampler.min_filter) {
        Some(Checked::Valid(MinFilter::Nearest)) if unblended => TextureFilter::Nearest,
        Some(Checked::Valid(MinFilter::Nearest | MinFilter::Linear)) => TextureFilter::Bilinear,
        _ => TextureFilter::Trilinear,
    }
}

/// Decodes a picture. The first bytes determine its format. Habitat makes smaller copies of PNG and JPEG itself, and of Basis it
/// takes those in the file (`ResourceManager::loadTextures`).
fn decode_texture(bytes: &[u8]) -> Result<DecodedPicture, String> {
    // "sB", the signature of a .basis file.
    if bytes.starts_with(b"sB") {
        return decode_basis(bytes);
    }
    Ok(DecodedPicture { texture: decode_common(bytes)?, has_levels: true })
}

/// Most texels of all pictures together, for a file of this many bytes. A limit for each picture is not enough, because
/// many pictures may refer to the same bytes.
pub(super) fn max_total_texels(bytes: u64) -> u64 {
    4 * FREE_TEXELS + TEXELS_PER_BYTE.saturating_mul(bytes)
}

/// Returns an error for a picture with far more texels than its bytes can hold.
fn check_size(width: u32, height: u32, bytes: usize) -> Result<(), String> {
    let texels = u64::from(width) * u64::from(height);
    if width.max(height) > MAX_TEXTURE_SIDE || texels > FREE_TEXELS + TEXELS_PER_BYTE * bytes as u64 {
        return Err(format!("{width} x {height} texels in {bytes} bytes: too large"));
    }
    Ok(())
}

fn decode_common(bytes: &[u8]) -> Result<Texture, String> {
    let open = || image::ImageReader::new(Cursor::new(bytes)).with_guessed_format().map_err(|error| error.to_string());
    let picture = run_decoder(|| {
        let (width, height) = open()?.into_dimensions().map_err(|error| error.to_string())?;
        check_size(width, height, bytes.len())?;
        open()?.decode().map_err(|error| error.to_string())
    })?;
    let picture = picture.into_rgba8();
    let texels = picture.pixels().map(|pixel| pixel.0).collect();
    Texture::new(picture.width(), picture.height(), texels).map_err(|error| error.to_string())
}

fn decode_basis(bytes: &[u8]) -> Result<DecodedPicture, String> {
    run_decoder(|| {
        let transcoder = Transcoder::new(bytes).map_err(|error| format!("Basis: {error:?}"))?;
        let (width, height) = transcoder.base_dimensions();
        check_size(width, height, bytes.len())?;
        let rgba = transcoder.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE);
        let rgba = rgba.map_err(|error| format!("Basis: {error:?}"))?;
        let texture = Texture::new(width, height, rgba.as_chunks().0.to_vec()).map_err(|error| error.to_string())?;
        Ok(DecodedPicture { texture, has_levels: transcoder.level_count() > 1 })
    })
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// 16 x 16 texels in ETC1S, in base64: the left half red, the right half green above blue. Made with the reference
    /// encoder (basis_universal 1.16) from a picture of the project's own.
    const ETC1S: &str = "c0ITAE0AvwSIAAAAIxABAAABAAAAEQAAAAAAAAAAAAAAAAAAAAAAAwBkAAAALwAAAwCTAAAADQAAoAAAAC8AAABNAAAAAAAAAAAAAAAAAAAA\
    ABAAEAAEAAQAzwAAAAYAAADe6CBA3AABAAAASF6Q3QUwJQAAAAAAgGQHPAATAgQAAAAAyAEZACYABAAAAACQYjwDBAAAAKiqqqpSVVVVBRTA\
    hAABAAAAALJBBoAJAAAAAAAQZCXA1IABAABhABaonNwJEABMAAAAAAAAIIAA43s0aJ4G";

    /// The bytes of that file.
    pub(crate) fn etc1s() -> Vec<u8> {
        base64::Engine::decode(&base64::engine::general_purpose::STANDARD, ETC1S).unwrap()
    }

    #[test]
    fn basis_files_are_unpacked() {
        let DecodedPicture { texture, has_levels } = decode_texture(&etc1s()).unwrap();
        assert!(!has_levels);
        assert_eq!((texture.width, texture.height), (16, 16));
        for (x, y, expected) in [(2, 8, [200, 40, 40]), (13, 2, [40, 200, 40]), (13, 13, [40, 40, 200])] {
            let [red, green, blue, _] = texture.texels[16 * y + x];
            let off = [red, green, blue].iter().zip(expected).map(|(a, b)| a.abs_diff(b)).max().unwrap();
            assert!(off <= 12, "({x}, {y}) is {red} {green} {blue}");
        }
    }

    fn png(width: u32, height: u32, rgba: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let encoder = image::codecs::png::PngEncoder::new(&mut bytes);
        image::ImageEncoder::write_image(encoder, rgba, width, height, image::ExtendedColorType::Rgba8).unwrap();
        bytes
    }

    #[test]
    fn pngs_keep_their_texels() {
        let DecodedPicture { texture, .. } = decode_texture(&png(2, 1, &[1, 2, 3, 255, 4, 5, 6, 7])).unwrap();
        assert_eq!((texture.width, texture.height, texture.texels), (2, 1, vec![[1, 2, 3, 255], [4, 5, 6, 7]]));
    }

    #[test]
    fn decode_refuses_pictures_far_larger_than_their_bytes() {
        let mut bytes = png(1, 1, &[0; 4]);
        // The width in the header, and its checksum.
        bytes[16..20].copy_from_slice(&16_000_u32.to_be_bytes());
        bytes[20..24].copy_from_slice(&16_000_u32.to_be_bytes());
        let mut crc = flate2::Crc::new();
        crc.update(&bytes[12..29]);
        bytes[29..33].copy_from_slice(&crc.sum().to_be_bytes());
        assert!(decode_texture(&bytes).err().unwrap().contains("16000 x 16000 texels in"));
    }

    #[test]
    fn decode_refuses_bytes_that_are_no_picture() {
        assert!(decode_texture(b"").is_err());
        assert!(decode_texture(b"sB").err().unwrap().starts_with("Basis: "));
        assert!(decode_texture(&[b's', b'B', 0x13, 0, 77, 0, 0xff, 0xff, 0xff, 0xff].repeat(20)).is_err());
    }
}
