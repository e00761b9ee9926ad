//! Commands of the whole program, as shells, farms and git run them. One test program, for each links all of coif.

mod alembic;
mod command_line;
mod compare;
mod farm;
mod messages;
mod probe;
mod refused;
mod render;
mod templates;
mod what_ran;
mod writing;
