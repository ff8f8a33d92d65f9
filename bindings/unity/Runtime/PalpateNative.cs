// The functions of palpate.h. Static P/Invoke with blittable arguments alone, as IL2CPP needs.
using System;
using System.Runtime.InteropServices;
using System.Text;

namespace Palpate
{
    internal static class PalpateNative
    {
        /// <summary>PALPATE_ABI_VERSION that the structs here match.</summary>
        public const uint AbiVersion = 0;

        // palpate_core.dll on Windows, libpalpate_core.so on Linux.
        private const string Library = "palpate_core";

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern uint palpate_abi_version();

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr palpate_version();

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr palpate_last_error();

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr palpate_fault_words(uint fault);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_open(ref NativeOptions options, out IntPtr simulation);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_close(IntPtr simulation);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_get_info(IntPtr simulation, ref Info info);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr palpate_name(IntPtr simulation);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr palpate_remark(IntPtr simulation, UIntPtr index);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_tick(IntPtr simulation, [In] Sample[] samples, [In, Out] Result[] results,
                                              UIntPtr hands);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_reset_fault(IntPtr simulation, uint handBits);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_restart(IntPtr simulation);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_scripted_sample(IntPtr simulation, uint hand, ulong tick, ref Sample sample);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_set_tissue(IntPtr simulation, [In] byte[] tissue);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern IntPtr palpate_tissue_field(UIntPtr index);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_set_tissue_value(IntPtr simulation, [In] byte[] field, double value);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_get_tissue_value(IntPtr simulation, [In] byte[] field, out double value);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_set_noise(IntPtr simulation, int enabled, double gain, double threshold);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_get_noise(IntPtr simulation, out int enabled, out double gain,
                                                   out double threshold);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern UIntPtr palpate_inclusion_count(IntPtr simulation);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_get_inclusion(IntPtr simulation, UIntPtr index,
                                                       ref NativeInclusion inclusion);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_set_inclusion(IntPtr simulation, UIntPtr index,
                                                       ref NativeInclusion inclusion);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_surface_update(IntPtr simulation, ref Picture picture);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_surface_vertices(IntPtr simulation, [In, Out] double[] xyz,
                                                          UIntPtr capacity);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_surface_triangles(IntPtr simulation, [In, Out] int[] corners,
                                                           UIntPtr capacity);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_tool_part(IntPtr simulation, uint hand, uint part, ref NativePart info);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_part_vertices(IntPtr simulation, uint hand, uint part,
                                                       [In, Out] double[] xyz, UIntPtr capacity);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_part_triangles(IntPtr simulation, uint hand, uint part,
                                                        [In, Out] int[] corners, UIntPtr capacity);

        [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
        public static extern int palpate_part_pose(IntPtr simulation, uint hand, uint part, double gripper,
                                                   out Vec3d position, out Quatd orientation);

        /// <summary>A text for C: UTF-8 with a final zero. Null stays null.</summary>
        public static byte[] Utf8(string text)
        {
            if (text == null) return null;
            if (text.IndexOf('\0') >= 0) throw new ArgumentException("a text for Palpate must not contain U+0000");
            var bytes = new byte[Encoding.UTF8.GetByteCount(text) + 1];
            Encoding.UTF8.GetBytes(text, 0, text.Length, bytes, 0);
            return bytes;
        }

        /// <summary>A text from C. Null stays null.</summary>
        public static string Text(IntPtr utf8)
        {
            if (utf8 == IntPtr.Zero) return null;
            int length = 0;
            while (Marshal.ReadByte(utf8, length) != 0) ++length;
            var bytes = new byte[length];
            Marshal.Copy(utf8, bytes, 0, length);
            return Encoding.UTF8.GetString(bytes);
        }

        public static UIntPtr SizeOf<T>() where T : struct
        {
            return (UIntPtr)(uint)Marshal.SizeOf(typeof(T));
        }
    }
}
