//! Builds the shape of every kind of furniture from simple parts: boxes, cushions, turned and bent pieces.

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

use super::{catalogue::FurnitureKind, colour::Colour, model::Furniture, rect::Wall};
pub(crate) use builder::{Part, Shape};

/// The properties of a piece that its shape depends on.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Look {
    /// Width, metres.
    w: f32,
    /// Depth, metres.
    d: f32,
    /// Height, metres.
    h: f32,
    colour: Colour,
    variant: u32,
}

impl Look {
    pub(crate) fn of(piece: &Furniture) -> Self {
        let along_x = Wall::ALL[usize::from(piece.quarter_turns) % 4].along_x();
        let (x, y) = (piece.footprint.width() as f32 / 100.0, piece.footprint.depth() as f32 / 100.0);
        let (w, d) = if along_x { (x, y) } else { (y, x) };
        Self { w, d, h: piece.height_cm as f32 / 100.0, colour: piece.colour, variant: piece.variant }
    }

    /// Half the width and half the depth.
    fn half(&self) -> (f32, f32) {
        (self.w / 2.0, self.d / 2.0)
    }
}

/// The shape of a piece, in its own frame.
pub(crate) fn shape(kind: FurnitureKind, look: &Look) -> Shape {
    use FurnitureKind as K;
    match kind {
        K::Sofa | K::Armchair => seating::sofa(look),
        K::Chair => seating::chair(look),
        K::BarStool => seating::stool(look),
        K::Bench => seating::bench(look),
        K::OfficeChair => seating::office_chair(look),
        K::CoffeeTable | K::DiningTable | K::ConsoleTable => tables::laid_table(look),
        K::SideTable => tables::table(look),
        K::Desk => tables::desk(look),
        K::Workbench => garage::workbench(look),
        K::TvStand => storage::tv_stand(look),
        K::Sideboard => storage::low_cabinet(look),
        K::Dresser => storage::drawers(look, 2, 3),
        K::Nightstand => storage::drawers(look, 1, 2),
        K::FilingCabinet => storage::filing_cabinet(look),
        K::Bookshelf => storage::bookshelf(look),
        K::Wardrobe => storage::wardrobe(look),
        K::ShoeRack => storage::shoe_rack(look),
        K::Shelf => storage::wall_shelf(look),
        K::ClothesRack => storage::clothes_rack(look),
        K::CoatRack => storage::coat_rack(look),
        K::Boxes => garage::boxes(look),
        K::MetalShelf => garage::metal_shelf(look),
        K::Bed => beds::bed(look),
        K::Counter => kitchen::counter(look),
        K::KitchenSink => kitchen::sink(look),
        K::Stove => kitchen::stove(look),
        K::Refrigerator => kitchen::refrigerator(look),
        K::WallCabinet => kitchen::wall_cabinet(look),
        K::RangeHood => kitchen::range_hood(look),
        K::Island => kitchen::island(look),
        K::Microwave => kitchen::microwave(look),
        K::Toaster => kitchen::toaster(look),
        K::Kettle => kitchen::kettle(look),
        K::FruitBowl => kitchen::fruit_bowl(look),
        K::Toilet => bathroom::toilet(look),
        K::Vanity => bathroom::vanity(look),
        K::Bathtub => bathroom::bathtub(look),
        K::Shower => bathroom::shower(look),
        K::Towel => bathroom::towel(look),
        K::Mirror => decoration::mirror(look),
        K::Painting => decoration::painting(look),
        K::Radiator => decoration::radiator(look),
        K::ClosetDoor => storage::closet_door(look),
        K::WallBookshelf => storage::bookshelf(look),
        K::Clock => decoration::clock(look),
        K::Whiteboard => decoration::whiteboard(look),
        K::Photos => hangings::photos(look),
        K::Tapestry => hangings::tapestry(look),
        K::CoatHooks => hangings::coat_hooks(look),
        K::BulletinBoard => hangings::bulletin_board(look),
        K::ToolBoard => hangings::tool_board(look),
        K::GrandfatherClock => showpieces::grandfather_clock(look),
        K::Rug => decoration::rug(look),
        K::BathMat | K::DoorMat => decoration::mat(look),
        K::Curtain => decoration::curtain(look),
        K::Fireplace => showpieces::fireplace(look),
        K::Piano => showpieces::piano(look),
        K::Vase => plants::vase(look),
        K::Plant => plants::plant(look),
        K::Television => devices::television(look),
        K::Computer => devices::computer(look),
        K::Globe => devices::globe(look),
        K::FloorLamp => lamps::floor_lamp(look),
        K::TableLamp => lamps::table_lamp(look),
        K::CeilingLight => lamps::ceiling_light(look),
        K::Chandelier => lamps::chandelier(look),
        K::Washer => laundry::washer(look),
        K::Dryer => laundry::dryer(look),
        K::LaundryBasket => laundry::basket(look),
        K::IroningBoard => laundry::ironing_board(look),
        K::Car => vehicles::car(look),
        K::Bicycle => vehicles::bicycle(look),
    }
}

#[cfg(test)]
mod tests;
