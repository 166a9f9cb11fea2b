// Maps a log and prints what the map is, by its hash:  map LOG FOLDER  (docs/howto/c.md)
use std::{ffi::CStr, ffi::CString, os::raw::c_char, os::raw::c_void};
#[repr(C)]
struct Error { size: usize, status: i32, text: [c_char; 1012] }
extern "C" {
    fn gdtslam_map_log(log: *const c_char, folder: *const c_char, run: *mut *mut c_void, error: *mut Error) -> i32;
    fn gdtslam_run_map_sha256(run: *const c_void) -> *const c_char;
    fn gdtslam_run_trajectory_sha256(run: *const c_void) -> *const c_char;
    fn gdtslam_run_free(run: *mut c_void);
}
fn fail(text: &str, status: i32) -> ! { eprintln!("{}", text); std::process::exit(status) }
fn text_of(text: *const c_char) -> String { unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned() }
fn main() {
    let paths: Vec<CString> = std::env::args().skip(1).map(|path| CString::new(path).unwrap()).collect();
    let (mut error, mut run) = (Error { size: std::mem::size_of::<Error>(), status: 0, text: [0; 1012] }, std::ptr::null_mut());
    if paths.len() != 2 { fail("Usage: map LOG FOLDER", 2) }
    let status = unsafe { gdtslam_map_log(paths[0].as_ptr(), paths[1].as_ptr(), &mut run, &mut error) };
    if status != 0 { fail(&format!("map: {}", text_of(error.text.as_ptr())), status) }
    println!("{} {}", text_of(unsafe { gdtslam_run_map_sha256(run) }), text_of(unsafe { gdtslam_run_trajectory_sha256(run) }));
    unsafe { gdtslam_run_free(run) } }
