// SPDX-FileCopyrightText: 2026 Ravenbrick contributors
// SPDX-License-Identifier: Apache-2.0
//! A minimal writer of ELF executables for ARM (System V ABI, chapters 4 and 5).

const HEADER: u32 = 52;
const PROGRAM_HEADER: u32 = 32;
const SECTION_HEADER: u16 = 40;
const ABSOLUTE: u16 = 0xFFF1;

/// A segment of the file.
#[derive(Clone)]
pub struct Load {
    pub virtual_address: u32,
    pub physical_address: u32,
    pub bytes: Vec<u8>,
    pub memory_size: u32,
}

/// A symbol of the file.
#[derive(Clone)]
pub struct Named {
    pub name: String,
    pub address: u32,
    pub size: u32,
    pub function: bool,
    pub global: bool,
}

/// The file under construction.
#[derive(Clone, Default)]
pub struct ElfBuilder {
    entry: u32,
    loads: Vec<Load>,
    symbols: Vec<Named>,
}

impl ElfBuilder {
    pub fn new(entry: u32) -> Self {
        Self {
            entry,
            ..Self::default()
        }
    }

    pub fn segment(self, address: u32, bytes: &[u8]) -> Self {
        let memory_size = bytes.len() as u32;
        self.load(address, address, bytes, memory_size)
    }

    pub fn load(mut self, virtual_: u32, physical: u32, bytes: &[u8], memory_size: u32) -> Self {
        self.loads.push(Load {
            virtual_address: virtual_,
            physical_address: physical,
            bytes: bytes.to_vec(),
            memory_size,
        });
        self
    }

    pub fn words(self, address: u32, words: &[u32]) -> Self {
        let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
        self.segment(address, &bytes)
    }

    pub fn function(self, name: &str, address: u32) -> Self {
        self.symbol(name, address, 4, true, true)
    }

    pub fn object(self, name: &str, address: u32, size: u32) -> Self {
        self.symbol(name, address, size, false, true)
    }

    pub fn symbol(
        mut self,
        name: &str,
        address: u32,
        size: u32,
        function: bool,
        global: bool,
    ) -> Self {
        self.symbols.push(Named {
            name: name.to_owned(),
            address,
            size,
            function,
            global,
        });
        self
    }

    pub fn build(&self) -> Vec<u8> {
        let contents_at = HEADER + PROGRAM_HEADER * self.loads.len() as u32;
        let contents_length: u32 = self.loads.iter().map(|load| load.bytes.len() as u32).sum();
        let (table, strings) = self.symbol_table();
        let section_names = b"\0.symtab\0.strtab\0.shstrtab\0";
        let table_at = contents_at + contents_length;
        let strings_at = table_at + table.len() as u32;
        let names_at = strings_at + strings.len() as u32;
        let sections_at = names_at + section_names.len() as u32;
        let mut file = self.header(sections_at);
        let mut offset = contents_at;
        for load in &self.loads {
            program_header(&mut file, load, offset);
            offset += load.bytes.len() as u32;
        }
        self.loads.iter().for_each(|load| file.extend(&load.bytes));
        file.extend(&table);
        file.extend(&strings);
        file.extend(section_names);
        section(&mut file, [0; 10]);
        let locals = 1 + self.symbols.iter().filter(|symbol| !symbol.global).count() as u32;
        section(
            &mut file,
            [1, 2, 0, 0, table_at, table.len() as u32, 2, locals, 4, 16],
        );
        section(
            &mut file,
            [9, 3, 0, 0, strings_at, strings.len() as u32, 0, 0, 1, 0],
        );
        section(
            &mut file,
            [
                17,
                3,
                0,
                0,
                names_at,
                section_names.len() as u32,
                0,
                0,
                1,
                0,
            ],
        );
        file
    }

    fn header(&self, sections_at: u32) -> Vec<u8> {
        let mut file = vec![0x7F, b'E', b'L', b'F', 1, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        halves(&mut file, &[2, 40]);
        words(
            &mut file,
            &[1, self.entry, HEADER, sections_at, 0x0500_0000],
        );
        let (program, count) = (PROGRAM_HEADER as u16, self.loads.len() as u16);
        halves(
            &mut file,
            &[HEADER as u16, program, count, SECTION_HEADER, 4, 3],
        );
        file
    }

    fn symbol_table(&self) -> (Vec<u8>, Vec<u8>) {
        let (mut table, mut strings) = (vec![0; 16], vec![0]);
        let mut ordered: Vec<&Named> = self.symbols.iter().collect();
        ordered.sort_by_key(|symbol| symbol.global);
        for symbol in ordered {
            words(
                &mut table,
                &[strings.len() as u32, symbol.address, symbol.size],
            );
            let binding = if symbol.global { 0x10 } else { 0 };
            table.extend([binding | if symbol.function { 2 } else { 1 }, 0]);
            halves(&mut table, &[ABSOLUTE]);
            strings.extend(symbol.name.as_bytes());
            strings.push(0);
        }
        (table, strings)
    }
}

fn program_header(file: &mut Vec<u8>, load: &Load, offset: u32) {
    let length = load.bytes.len() as u32;
    let (at, physical) = (load.virtual_address, load.physical_address);
    words(
        file,
        &[1, offset, at, physical, length, load.memory_size, 7, 4],
    );
}

fn section(file: &mut Vec<u8>, fields: [u32; 10]) {
    words(file, &fields);
}

fn words(file: &mut Vec<u8>, words: &[u32]) {
    words
        .iter()
        .for_each(|word| file.extend(word.to_le_bytes()));
}

fn halves(file: &mut Vec<u8>, halves: &[u16]) {
    halves
        .iter()
        .for_each(|half| file.extend(half.to_le_bytes()));
}
