//! Builds the shape of every kind of furniture from simple parts: boxes, cushions, turned and bent pieces.
//!
//! A piece is built in its own frame: centred on the origin, with its foot at z = 0, with its front towards -y. There is one file
//! for each group of furniture; `builder.rs` has the simple parts.

mod bathroom;
mod beds;
mod builder;
mod clutter;
mod decoration;
mod devices;
mod garage;
mod hangings;
mod kitchen;
mod lamps;
mod laundry;
mod plants;
mod seating;
mod showpieces;
mod storage;
mod tables;
mod vehicles;

use super::{catalogue::FurnitureKind, colour::Colour, model::FurniturePiece, rect::WallSide};
pub(crate) use builder::{HouseShape, MeshPart};

/// The properties of a piece that its shape depends on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FurnitureLook {
    /// Width, metres.
    w: f32,
    /// Depth, metres.
    d: f32,
    /// Height, metres.
    h: f32,
    colour: Colour,
    /// Number that chooses details, such as the colour of a frame or the things on a table.
    variant: u32,
}

impl FurnitureLook {
    pub(crate) fn for_piece(piece: &FurniturePiece) -> Self {
        let along_x = WallSide::ALL[usize::from(piece.quarter_turns) % 4].along_x();
        let (x, y) = (piece.footprint.width() as f32 / 100.0, piece.footprint.depth() as f32 / 100.0);
        let (w, d) = if along_x { (x, y) } else { (y, x) };
        Self { w, d, h: piece.height_cm as f32 / 100.0, colour: piece.colour, variant: piece.variant }
    }

    /// Half the width and half the depth.
    fn half_size(&self) -> (f32, f32) {
        (self.w / 2.0, self.d / 2.0)
    }
}

/// The shape of a piece, in its own frame.
pub(crate) fn build_shape(kind: FurnitureKind, look: &FurnitureLook) -> HouseShape {
    use FurnitureKind as K;
    match kind {
        K::Sofa | K::Armchair => seating::build_sofa(look),
        K::Chair => seating::build_chair(look),
        K::BarStool => seating::build_stool(look),
        K::Bench => seating::build_bench(look),
        K::OfficeChair => seating::build_office_chair(look),
        K::CoffeeTable | K::DiningTable | K::ConsoleTable => tables::build_laid_table(look),
        K::SideTable => tables::build_table(look),
        K::Desk => tables::build_desk(look),
        K::Workbench => garage::build_workbench(look),
        K::TvStand => storage::build_tv_stand(look),
        K::Sideboard => storage::build_sideboard(look),
        K::Dresser => storage::build_drawers(look, 2, 3),
        K::Nightstand => storage::build_drawers(look, 1, 2),
        K::FilingCabinet => storage::build_filing_cabinet(look),
        K::Bookshelf => storage::build_bookshelf(look),
        K::Wardrobe => storage::build_wardrobe(look),
        K::ShoeRack => storage::build_shoe_rack(look),
        K::Shelf => storage::build_wall_shelf(look),
        K::ClothesRack => storage::build_clothes_rack(look),
        K::CoatRack => storage::build_coat_rack(look),
        K::Boxes => garage::build_boxes(look),
        K::MetalShelf => garage::build_metal_shelf(look),
        K::Bed => beds::build_bed(look),
        K::Counter => kitchen::build_counter(look),
        K::KitchenSink => kitchen::build_sink(look),
        K::Stove => kitchen::build_stove(look),
        K::Refrigerator => kitchen::build_refrigerator(look),
        K::WallCabinet => kitchen::build_wall_cabinet(look),
        K::RangeHood => kitchen::build_range_hood(look),
        K::Island => kitchen::build_island(look),
        K::Microwave => kitchen::build_microwave(look),
        K::Toaster => kitchen::build_toaster(look),
        K::Kettle => kitchen::build_kettle(look),
        K::FruitBowl => kitchen::build_fruit_bowl(look),
        K::Toilet => bathroom::build_toilet(look),
        K::Vanity => bathroom::build_vanity(look),
        K::Bathtub => bathroom::build_bathtub(look),
        K::Shower => bathroom::build_shower(look),
        K::Towel => bathroom::build_towel(look),
        K::Mirror => decoration::build_mirror(look),
        K::Painting => decoration::build_painting(look),
        K::Radiator => decoration::build_radiator(look),
        K::ClosetDoor => storage::build_closet_door(look),
        K::WallBookshelf => storage::build_bookshelf(look),
        K::Clock => decoration::build_clock(look),
        K::Whiteboard => decoration::build_whiteboard(look),
        K::Photos => hangings::build_photos(look),
        K::Tapestry => hangings::build_tapestry(look),
        K::CoatHooks => hangings::build_coat_hooks(look),
        K::BulletinBoard => hangings::build_bulletin_board(look),
        K::ToolBoard => hangings::build_tool_board(look),
        K::GrandfatherClock => showpieces::build_grandfather_clock(look),
        K::Rug => decoration::build_rug(look),
        K::BathMat | K::DoorMat => decoration::build_mat(look),
        K::Curtain => decoration::build_curtain(look),
        K::Fireplace => showpieces::build_fireplace(look),
        K::Piano => showpieces::build_piano(look),
        K::Vase => plants::build_vase(look),
        K::Plant => plants::build_plant(look),
        K::Television => devices::build_television(look),
        K::Computer => devices::build_computer(look),
        K::Globe => devices::build_globe(look),
        K::FloorLamp => lamps::build_floor_lamp(look),
        K::TableLamp => lamps::build_table_lamp(look),
        K::CeilingLight => lamps::build_ceiling_light(look),
        K::Chandelier => lamps::build_chandelier(look),
        K::Washer => laundry::build_washer(look),
        K::Dryer => laundry::build_dryer(look),
        K::LaundryBasket => laundry::build_basket(look),
        K::IroningBoard => laundry::build_ironing_board(look),
        K::Car => vehicles::build_car(look),
        K::Bicycle => vehicles::build_bicycle(look),
    }
}

#[cfg(test)]
mod tests;
