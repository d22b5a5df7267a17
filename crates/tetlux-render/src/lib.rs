//! tetlux-render
