// A cell ready to be binned and composited: written once a cell, read by every tile that it may be seen in.
import package::lib::prepared::{Prepared};
import package::lib::tiles::{Footprint};

struct Ready {
    cell: Prepared,
    footprint: Footprint,
}
